/* farfield-export: writes a pack's ground for other programs. */
#include "export_options.h"
#include "export_run.h"

int main(int argc, char **argv)
{
    export_options options;
    int rc = export_options_parse(&options, argc, argv);
    if (rc) return rc < 0 ? SYS_EXIT_USAGE : SYS_EXIT_DONE;
    return export_run(&options) ? SYS_EXIT_FAILED : SYS_EXIT_DONE;
}
