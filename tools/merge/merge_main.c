/* farfield-merge: joins packs on one lattice. */
#include "merge_options.h"
#include "merge_run.h"

int main(int argc, char **argv)
{
    merge_options options;
    int rc = merge_options_parse(&options, argc, argv);
    if (rc) return rc < 0 ? SYS_EXIT_USAGE : SYS_EXIT_DONE;
    return merge_run(&options) ? SYS_EXIT_FAILED : SYS_EXIT_DONE;
}
