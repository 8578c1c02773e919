/* farfield-handheld: flies the client as it would run on the device. */
#include "handheld.h"

int main(int argc, char **argv)
{
    static handheld_options options;
    static handheld device;
    int rc = handheld_options_parse(&options, argc, argv);
    if (rc) return rc < 0 ? SYS_EXIT_USAGE : SYS_EXIT_DONE;
    rc = handheld_open(&device, &options);
    if (!rc && options.plan)
        handheld_plan(&device);
    else if (!rc)
        rc = handheld_fly(&device) || handheld_report(&device);
    handheld_close(&device);
    return rc ? SYS_EXIT_FAILED : SYS_EXIT_DONE;
}
