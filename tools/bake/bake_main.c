/* farfield-bake: a raster of heights becomes a pack. */
#include "bake_options.h"
#include "bake_run.h"

int main(int argc, char **argv)
{
    bake_options options;
    int rc = bake_options_parse(&options, argc, argv);
    if (rc) return rc < 0;
    return bake_run(&options) ? 1 : 0;
}
