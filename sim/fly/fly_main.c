/* farfield-fly: a flight over a pack, simulated (server, link and client in this process) or
 * against a real server. */
#include "../../platform/options/sys_output.h"
#include "fly_flight.h"

#include <errno.h>
#include <string.h>

int main(int argc, char **argv)
{
    static fly_options options;
    static fly_world world;
    fly_flight flight = { 0 };
    FILE *csv = NULL;
    int rc = fly_options_parse(&options, argc, argv);
    if (rc) return rc < 0 ? SYS_EXIT_USAGE : SYS_EXIT_DONE;
    if (fly_options_load(&options)) {
        fly_options_free(&options);
        return SYS_EXIT_FAILED;
    }
    fly_options_print(&options);
    rc = fly_world_open(&world, &options);
    if (!rc) rc = fly_recording_place(&options.recording, options.path_text, &world.geo);
    if (!rc && options.until_there) options.seconds = fly_path_seconds(&world.path);
    if (!rc && options.csv_path && !(csv = fopen(options.csv_path, "w"))) {
        fprintf(stderr, "farfield-fly: %s: %s\n", options.csv_path, strerror(errno));
        rc = -1;
    }
    if (csv) setvbuf(csv, NULL, _IOLBF, 1024); /* rows can be followed while they are made */
    if (!rc) rc = fly_flight_run(&flight, &world, csv);
    if (!rc && options.json)
        fly_json(stdout, &options, flight.sample, flight.sample_count, &flight.totals);
    if (csv && sys_output_close("farfield-fly", csv, options.csv_path)) rc = -1;
    if (!rc && flight.totals.crack_frames) {
        fprintf(stderr, "farfield-fly: %u of %u frames have cracks\n", flight.totals.crack_frames,
                flight.totals.frames);
        rc = -1;
    }
    fly_flight_free(&flight);
    fly_world_close(&world);
    fly_options_free(&options);
    return rc ? SYS_EXIT_FAILED : SYS_EXIT_DONE;
}
