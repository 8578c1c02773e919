/* Files: whole, read-only mappings; whole, atomic writes. */
#include "../sys.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

int sys_map_file(const char *path, sys_mapping *mapping)
{
    *mapping = (sys_mapping){ 0 };
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) return errno == ENOENT || errno == ENOTDIR ? FF_ERR_NOT_FOUND : FF_ERR_SYSTEM;
    struct stat status;
    int rc = FF_ERR_SYSTEM;
    if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) {
        void *bytes = NULL; /* an empty file cannot be mapped, and need not be */
        if (status.st_size > 0)
            bytes = mmap(NULL, (size_t)status.st_size, PROT_READ, MAP_SHARED, fd, 0);
        if (bytes != MAP_FAILED) {
            *mapping = (sys_mapping){ bytes, (uint64_t)status.st_size };
            rc = FF_OK;
        }
    }
    close(fd);
    return rc;
}

void sys_unmap_file(sys_mapping *mapping)
{
    if (mapping->bytes) munmap((void *)(uintptr_t)mapping->bytes, (size_t)mapping->size);
    *mapping = (sys_mapping){ 0 };
}

static int write_all(int fd, const uint8_t *bytes, size_t count)
{
    while (count > 0) {
        ssize_t written = write(fd, bytes, count);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return FF_ERR_SYSTEM;
        bytes += written;
        count -= (size_t)written;
    }
    return FF_OK;
}

int sys_write_file(const char *path, const void *bytes, size_t count)
{
    char temporary[4096];
    int length = snprintf(temporary, sizeof temporary, "%s.XXXXXX", path);
    if (length < 0 || (size_t)length >= sizeof temporary) return FF_ERR_ARGUMENT;
    int fd = mkostemp(temporary, O_CLOEXEC);
    if (fd < 0) return FF_ERR_SYSTEM;
    /* mkostemp makes 0600; a written file follows the umask as any other does */
    mode_t mask = umask(0);
    umask(mask);
    int rc = write_all(fd, bytes, count);
    if (fchmod(fd, 0666 & ~mask) != 0 || fsync(fd) != 0) rc = FF_ERR_SYSTEM;
    if (close(fd) != 0) rc = FF_ERR_SYSTEM;
    if (rc == FF_OK && rename(temporary, path) != 0) rc = FF_ERR_SYSTEM;
    if (rc < 0) unlink(temporary);
    return rc;
}
