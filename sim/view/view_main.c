/* farfield-view: the desktop emulator. */
#include "view_app.h"

static void print_counters(const view_app *app)
{
    ff_client_stats stats;
    ff_client_get_stats(app->client, &stats);
    printf(
        "{\"frames\": %u, \"drawn\": %u, \"events\": %u, \"updates\": %u, \"updates_skipped\": %u, \"triangles\": %u, "
        "\"nodes_drawn\": %u, \"nodes_held\": %u, \"bytes_down\": %llu, \"bytes_up\": %llu, \"requests\": %u, "
        "\"panoramas\": %u, \"low_power\": %u, \"reconnects\": %u, \"x_m\": %.1f, \"y_m\": %.1f, \"z_m\": %.1f}\n",
        app->frame, app->drawn, app->events_handled, stats.frames_updated, stats.frames_skipped,
        stats.tree.triangles, stats.tree.nodes_drawn, stats.tree.nodes_held,
        (unsigned long long)stats.bytes_down, (unsigned long long)stats.bytes_up,
        stats.requests_sent, stats.panorama_faces, stats.low_power, stats.reconnects,
        app->fly.camera.pos_wu[0] / (double)FF_WU_PER_METRE,
        app->fly.camera.pos_wu[1] / (double)FF_WU_PER_METRE,
        app->fly.camera.pos_wu[2] / (double)FF_WU_PER_METRE);
}

int main(int argc, char **argv)
{
    static view_app app;
    view_options options;
    int rc = view_options_parse(&options, argc, argv);
    if (rc) return rc < 0 ? SYS_EXIT_USAGE : SYS_EXIT_DONE;
    rc = view_app_open(&app, &options);
    if (rc == 0) rc = view_app_run(&app);
    if (rc >= 0 && options.json) print_counters(&app);
    if (view_app_close(&app) && rc >= 0) rc = -1;
    return rc < 0 ? SYS_EXIT_FAILED : SYS_EXIT_DONE;
}
