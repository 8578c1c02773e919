#include "bake_grid.h"

#include "../bake_say.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char temp_directory[3000] = ".";

void bake_temp_setup(const char *near_path)
{
    const char *told = getenv("FARFIELD_TMP");
    if (!told || !*told) told = getenv("TMPDIR");
    if (told && *told) {
        snprintf(temp_directory, sizeof temp_directory, "%s", told);
        return;
    }
    snprintf(temp_directory, sizeof temp_directory, "%s", near_path);
    char *slash = strrchr(temp_directory, '/');
    if (!slash)
        snprintf(temp_directory, sizeof temp_directory, ".");
    else if (slash == temp_directory)
        slash[1] = 0;
    else
        *slash = 0;
}

int bake_temp_open(void)
{
    char path[sizeof temp_directory + 32];
#ifdef O_TMPFILE /* it never has a name: whoever is killed leaves none */
    int unnamed = open(temp_directory, O_TMPFILE | O_RDWR, 0600);
    if (unnamed >= 0) return unnamed;
#endif
    snprintf(path, sizeof path, "%s/.farfield-XXXXXX", temp_directory);
    int fd = mkstemp(path);
    if (fd < 0)
        return bake_fail("cannot make a temporary file in %s: %s", temp_directory, strerror(errno));
    unlink(path);
    return fd;
}

int bake_grid_open(bake_grid *grid, uint32_t width, uint32_t height, uint32_t cell_bytes)
{
    *grid = (bake_grid){ -1, width, height, cell_bytes };
    grid->fd = bake_temp_open();
    return grid->fd < 0 ? -1 : 0;
}

void bake_grid_close(bake_grid *grid)
{
    if (grid->fd >= 0) close(grid->fd);
    grid->fd = -1;
}

int bake_pread(int fd, void *bytes, size_t count, uint64_t at)
{
    char *to = bytes;
    while (count) {
        ssize_t got = pread(fd, to, count, (off_t)at);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0)
            return bake_fail("cannot read: %s", got ? strerror(errno) : "file ends too early");
        to += got;
        at += (uint64_t)got;
        count -= (size_t)got;
    }
    return 0;
}

int bake_pwrite(int fd, const void *bytes, size_t count, uint64_t at)
{
    const char *from = bytes;
    while (count) {
        ssize_t put = pwrite(fd, from, count, (off_t)at);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return bake_fail("cannot write: %s", put ? strerror(errno) : "no space");
        from += put;
        at += (uint64_t)put;
        count -= (size_t)put;
    }
    return 0;
}

static uint64_t cell_at(const bake_grid *grid, uint32_t row, uint32_t column)
{
    return ((uint64_t)row * grid->width + column) * grid->cell_bytes;
}

int bake_grid_read(const bake_grid *grid, uint32_t row, uint32_t column, uint32_t count,
                   void *cells)
{
    return bake_pread(grid->fd, cells, (size_t)count * grid->cell_bytes,
                      cell_at(grid, row, column));
}

int bake_grid_write(const bake_grid *grid, uint32_t row, uint32_t column, uint32_t count,
                    const void *cells)
{
    return bake_pwrite(grid->fd, cells, (size_t)count * grid->cell_bytes,
                       cell_at(grid, row, column));
}

int bake_grid_range(const bake_grid *grid, float *low, float *high)
{
    float *row = malloc(grid->width * sizeof *row);
    int rc = row ? 0 : bake_fail("out of memory");
    *low = INFINITY;
    *high = -INFINITY;
    for (uint32_t j = 0; !rc && j < grid->height; j++) {
        rc = bake_grid_read(grid, j, 0, grid->width, row);
        for (uint32_t i = 0; !rc && i < grid->width; i++) {
            if (row[i] < *low) *low = row[i];
            if (row[i] > *high) *high = row[i];
        }
    }
    free(row);
    return rc;
}
