#include "../sys.h"

#include <sys/stat.h>
#include <unistd.h>

int sys_make_folder(const char *path)
{
    struct stat found;
    if (mkdir(path, 0777) == 0) return FF_OK;
    return stat(path, &found) == 0 && S_ISDIR(found.st_mode) ? FF_OK : FF_ERR_SYSTEM;
}

int sys_stderr_is_terminal(void) { return isatty(STDERR_FILENO) != 0; }
