/* farfield-bake: a raster of heights becomes a pack. */
#include "bake_options.h"
#include "bake_run.h"

int main(int argc, char **argv)
{
    bake_options options;
    int rc = bake_options_parse(&options, argc, argv);
    if (rc) return rc < 0 ? SYS_EXIT_USAGE : SYS_EXIT_DONE;
    return bake_run(&options) ? SYS_EXIT_FAILED : SYS_EXIT_DONE;
}
