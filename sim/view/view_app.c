#include "view_app.h"

#include "../../platform/options/sys_output.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define FRAME_US           16667
#define FRAME_US_LOW_POWER 100000
#define SCRIPT_STEP_US     33333 /* a scripted frame flies this long, whatever the clock says */
#define IDLE_SLEEP_US      10000
#define HUD_EVERY_US       250000
#define SETTLE_FRAMES      25 /* this many frames without news: settled */
#define SETTLE_US_MAX      60000000
#define DT_US_MAX          250000
#define JITTER_WAIT_US     2000

/* ---- opening ---- */
static int is_soft(const char *backend) { return !strcmp(backend, "soft"); }

static const sys_surface_api *surface_for(const view_options *o, enum sys_gl_kind gl)
{
    if (!o->headless) return sys_surface_glfw();
    if (gl == SYS_GL_NONE) return sys_surface_memory();
    return gl == SYS_GL_ES1 ? sys_surface_egl() : sys_surface_osmesa();
}

static int open_surface_of(view_app *app, enum sys_gl_kind gl)
{
    sys_surface_desc desc = { .title = "Farfield",
                              .width = app->options->size.width,
                              .height = app->options->size.height,
                              .gl = gl };
    app->surface_api = surface_for(app->options, gl);
    return app->surface_api ? app->surface_api->open(&desc, &app->surface) : FF_ERR_UNSUPPORTED;
}

/* A window for the soft back end has a GL all the same, to show the picture with: whichever GL it
 * can have. */
static int open_soft_window(view_app *app)
{
    static const enum sys_gl_kind kinds[2] = { SYS_GL_ES1, SYS_GL_DESKTOP };
    int rc = FF_ERR_UNSUPPORTED;
    for (int i = 0; i < 2 && rc == FF_ERR_UNSUPPORTED; i++) {
        const struct c3d_backend *backend = kinds[i] == SYS_GL_ES1 ? c3d_backend_gles1()
                                                                   : c3d_backend_gl();
        if ((rc = open_surface_of(app, kinds[i])) < 0) continue;
        rc = view_blit_open(&app->blit, backend, app->surface_api, app->options->size.width,
                            app->options->size.height);
        if (rc == FF_OK) return FF_OK;
        app->surface_api->close(app->surface);
        app->surface = NULL;
    }
    return rc;
}

static int open_surface(view_app *app, const char *backend)
{
    if (!is_soft(backend))
        return open_surface_of(app, strcmp(backend, "gl") ? SYS_GL_ES1 : SYS_GL_DESKTOP);
    return app->options->headless ? open_surface_of(app, SYS_GL_NONE) : open_soft_window(app);
}

static int create_client(view_app *app, const char *backend)
{
    const view_options *o = app->options;
    app->backend = is_soft(backend)        ? c3d_backend_soft()
                   : strcmp(backend, "gl") ? c3d_backend_gles1()
                                           : c3d_backend_gl();
    ff_client_desc desc = { .memory = app->memory,
                            .memory_bytes = o->memory_bytes,
                            .stream = app->link ? &app->stream : NULL,
                            .pack = app->link ? NULL : &app->packs.pack[0],
                            .more = app->more,
                            .more_count = (unsigned)o->packs.count,
                            .backend = app->backend,
                            .surface_api = app->surface_api,
                            .width = o->size.width,
                            .height = o->size.height,
                            .frame_format = C3D_RGBA8888,
                            .quality = app->quality,
                            .panorama = app->panorama,
                            .far = app->far,
                            .balance = o->balance,
                            .use_thread = 1,
                            .use_map = 1,
                            .layer = o->layer,
                            .about = SIM_ABOUT_SHOWN | SIM_WHERE_ABOUT,
                            .use_plain_arrays = (uint8_t)o->plain_arrays };
    return ff_client_create(&desc, &app->client);
}

static int open_with(view_app *app, const char *backend)
{
    int rc = open_surface(app, backend);
    if (rc < 0) return rc;
    rc = create_client(app, backend);
    if (rc == FF_OK) return FF_OK;
    view_blit_close(&app->blit);
    app->surface_api->close(app->surface);
    app->surface = NULL;
    return rc;
}

/* 1 when the ground is known, and has no layer of the name that was asked for. */
static int lacks_layer(const view_app *app)
{
    return app->options->layer && ff_client_layer(app->client) == FF_ERR_NOT_FOUND;
}

static int fail_layer(const view_app *app)
{
    return view_fail("--layer %s: the ground has no layer of images of this name",
                     app->options->layer);
}

static int open_picture(view_app *app)
{
    const char *backend = app->options->backend ? app->options->backend : "gles1";
    int rc = open_with(app, backend);
    if (rc == FF_ERR_UNSUPPORTED && !app->options->backend) rc = open_with(app, backend = "gl");
    if (rc == FF_ERR_MEMORY)
        return view_fail("--memory: %u bytes are too few", app->options->memory_bytes);
    if (rc < 0)
        return view_fail("no picture with %s%s: %s%s", backend,
                         app->options->headless ? " (headless)" : "", ff_error_text(rc),
                         app->options->headless ? "" : "; --headless needs no display");
    return lacks_layer(app) ? fail_layer(app) : 0;
}

static int open_pack(view_app *app, const char *path)
{
    return ff_packs_add(&app->packs, path) == FF_OK ? 0 : view_fail("%s", app->packs.why);
}

/* A target that is a file is a pack, all else is an address. A pack behind a link, or with
 * panoramas or far sets, is served from inside this process. */
static int open_terrain(view_app *app)
{
    const view_options *o = app->options;
    FILE *file = fopen(o->target, "rb");
    int is_pack = file || !strchr(o->target, ':'), rc;
    if (file) fclose(file);
    if (is_pack && open_pack(app, o->target)) return -1;
    for (size_t i = 0; i < o->packs.count; i++) {
        if (open_pack(app, o->packs.text[i])) return -1;
        app->more[i].pack = &app->packs.pack[app->packs.count - 1];
    }
    app->panorama.enabled = (uint8_t)o->use_panorama;
    app->far = o->far;
    if (is_pack && !o->link && !app->panorama.enabled && !o->far_given) return 0;
    rc = view_link_create(is_pack ? NULL : o->target, &app->packs.pack[0], o->link, &app->link,
                          &app->stream);
    if (rc == FF_ERR_ARGUMENT) return view_fail("%s: neither a pack nor ADDR:PORT", o->target);
    return rc < 0 ? view_fail("%s: %s", o->target, ff_error_text(rc)) : 0;
}

static int open_files(view_app *app)
{
    const view_options *o = app->options;
    char why[2048];
    int rc = o->script ? view_script_load(&app->script, o->script, why, sizeof why)
             : o->keys ? view_script_keys(&app->script, o->keys, why, sizeof why)
                       : 0;
    if (rc) return view_fail("%s", why);
    if (!o->events) return 0;
    app->events = strcmp(o->events, "-") ? fopen(o->events, "w") : stdout;
    return app->events ? 0 : view_fail("%s: %s", o->events, strerror(errno));
}

int view_app_open(view_app *app, const view_options *options)
{
    memset(app, 0, sizeof *app);
    app->options = options;
    app->quality = options->quality;
    app->show_hud = !options->no_hud;
    app->memory = malloc(options->memory_bytes);
    if (!app->memory) return view_fail("out of memory");
    view_fly_init(&app->fly, options->size.width, options->size.height, options->fov_brad16);
    app->fly.camera.yaw = options->yaw_brad16;
    app->map.part_q16 = 65536;
    if (open_files(app) || open_terrain(app) || open_picture(app)) return -1;
    app->show = options->show;
    ff_client_set_show(app->client, app->show);
    return 0;
}

int view_app_close(view_app *app)
{
    int rc = app->events && app->events != stdout
                 ? sys_output_close("farfield-view", app->events, app->options->events)
                 : 0;
    if (app->client) ff_client_destroy(app->client);
    view_blit_close(&app->blit);
    if (app->surface) app->surface_api->close(app->surface);
    view_link_destroy(app->link);
    ff_packs_close(&app->packs);
    view_script_free(&app->script);
    free(app->memory);
    return rc;
}

/* ---- one frame ---- */
static int write_screenshot(view_app *app, c3d_device *device)
{
    const c3d_camera *camera = &app->fly.camera;
    const char *path = app->screenshot;
    uint8_t *rgb = malloc((size_t)camera->width * camera->height * 3);
    int rc = rgb ? c3d_read_rgb(device, rgb) : FF_ERR_MEMORY;
    if (rc >= 0) rc = sys_png_write(path, rgb, camera->width, camera->height);
    free(rgb);
    app->screenshot = NULL;
    return rc < 0 ? view_fail("%s: %s", path, ff_error_text(rc)) : 0;
}

static int draw(view_app *app)
{
    c3d_device *device = ff_client_device(app->client);
    ff_client_draw(app->client);
    app->redraw = 0;
    app->drawn++;
    if (!device) return view_fail("--memory: too little for a picture");
    if (app->show_hud || app->show_pools || app->show_help || view_map_shown(&app->map))
        view_hud_draw(&app->hud, app, device);
    int rc = app->screenshot ? write_screenshot(app, device) : 0;
    if (app->blit.device && view_blit_show(&app->blit, device) < 0)
        return view_fail("cannot show the picture in the window");
    app->surface_api->present(app->surface);
    return rc;
}

/* Runs the script's steps that are due. While settling the script waits. */
static void run_script(view_app *app)
{
    const view_step *step;
    while (!app->settling && !app->quit && !app->screenshot &&
           (step = view_script_next(&app->script, app->frame))) {
        switch (step->kind) {
            case VIEW_STEP_EVENT: {
                sys_event event = step->event;
                event.time_us = sys_time_us();
                /* the queue is full: next frame */
                if (sys_event_inject(&event) < 0) app->script.next--;
                return; /* one event a frame at most: a screenshot sees what came before */
            }
            case VIEW_STEP_SETTLE:
                app->settling = 1;
                app->still_frames = 0;
                app->settle_until_us = sys_time_us() + SETTLE_US_MAX;
                break;
            case VIEW_STEP_SCREENSHOT: app->screenshot = step->path; break;
            case VIEW_STEP_QUIT: app->quit = 1; break;
        }
    }
}

static void watch_settling(view_app *app, int changed)
{
    ff_client_stats stats;
    ff_client_get_stats(app->client, &stats);
    int heard = stats.have_terrain && app->fly.placed &&
                ff_client_source_state(app->client, 0) != FF_ERR_AGAIN,
        busy = changed || !heard || stats.in_flight || stats.queued;
    app->still_frames = busy ? 0 : app->still_frames + 1;
    if (app->still_frames < SETTLE_FRAMES && sys_time_us() < app->settle_until_us) return;
    if (busy) view_fail("still busy after %d s, going on", SETTLE_US_MAX / 1000000);
    app->settling = 0;
}

/* FF_OK, or why a place on Earth is not found: FF_ERR_AGAIN, a server has not told yet where its
 * ground lies. Not given, it leaves `place` as it is. */
static int find_on_earth(view_app *app, const sim_spot *on_earth, view_place *place)
{
    int32_t xy_wu[2];
    if (!on_earth->given) return FF_OK;
    int rc = sim_where_ask(&app->where, app->client);
    if (rc == FF_OK)
        rc = sim_spot_find(on_earth, &app->where.geo, ff_client_terrain(app->client), xy_wu);
    if (rc != FF_OK) return rc;
    *place = (view_place){ 1, xy_wu[0], xy_wu[1],
                           on_earth->above_wu < 0 ? place->above_wu : on_earth->above_wu };
    return FF_OK;
}

static int fail_place(const char *option, int rc)
{
    return rc == FF_ERR_AGAIN ? 0 : view_fail("%s: %s", option, sim_spot_why(rc));
}

/* 0, or -1 having said why --at or --to is no place. */
static int place_pilot(view_app *app)
{
    const view_options *o = app->options;
    const ff_terrain_info *info = ff_client_terrain(app->client);
    view_place at = o->place, to = { 0 };
    if (app->fly.placed || !info) return 0;
    int rc = find_on_earth(app, &o->at, &at);
    if (rc != FF_OK) return fail_place("--at", rc);
    to.above_wu = at.above_wu;
    rc = find_on_earth(app, &o->to, &to);
    if (rc != FF_OK) return fail_place("--to", rc);
    view_fly_place(&app->fly, info, !at.given, at.x_wu, at.y_wu, at.above_wu);
    if (to.given) view_fly_to(&app->fly, to.x_wu, to.y_wu, to.above_wu);
    return 0;
}

/* --map: as soon as the ground is known below the pilot, who is set over it then. */
static void begin_map(view_app *app)
{
    const c3d_camera *camera = &app->fly.camera;
    int32_t ground_wu;
    if (app->map_begun || !app->options->map) return;
    if (!ff_client_ground(app->client, camera->pos_wu[0], camera->pos_wu[1], &ground_wu)) return;
    (void)view_fly_step(&app->fly, 0, app->client);
    view_map_toggle(&app->map, &app->fly, app->client, 0);
    app->map_begun = 1;
}

/* The pilot's view, or the map's. */
static c3d_camera see(view_app *app, int64_t dt_us)
{
    c3d_camera camera = app->fly.camera;
    if (!app->fly.placed) return camera;
    begin_map(app);
    uint8_t map_quality = (uint8_t)view_map_step(&app->map, &app->fly, dt_us, app->client, &camera);
    if (map_quality != app->map_quality) {
        app->map_quality = map_quality;
        view_set_quality(app);
    }
    view_map_tell(&app->map, &app->fly, app->client);
    return camera;
}

/* Once of each pack that is not shown, why. */
static void tell_what_fits_not(view_app *app)
{
    for (unsigned i = 0; i < app->options->packs.count; i++) {
        int rc = ff_client_source_state(app->client, 1 + i);
        if (rc == FF_OK || rc == FF_ERR_AGAIN || app->told >> i & 1u) continue;
        app->told |= (uint8_t)(1u << i);
        view_fail("%s is not shown: %s", app->options->packs.text[i], ff_packs_why_apart(rc));
    }
}

/* A server's ground is known only once it has been heard: ground is shown without images then. */
static void tell_layer(view_app *app)
{
    if (app->layer_known || ff_client_layer(app->client) == FF_ERR_AGAIN) return;
    app->layer_known = 1;
    if (lacks_layer(app)) fail_layer(app);
}

/* 1 when the text on the picture would change; looked at a few times a second. */
static int hud_changed(view_app *app, int64_t now_us)
{
    if ((!app->show_hud && !app->show_pools && !view_map_shown(&app->map)) || now_us < app->hud_us)
        return 0;
    app->hud_us = now_us + HUD_EVERY_US;
    return view_hud_update(&app->hud, app);
}

/* One turn of the loop; -1 on an error already said. */
static int turn(view_app *app, int64_t now_us, int64_t dt_us)
{
    sys_event event;
    run_script(app);
    while (app->surface_api->poll(app->surface, &event)) view_handle(app, &event);
    (void)sim_where_ask(&app->where, app->client);
    if (place_pilot(app)) return -1;
    if (app->settling || app->interrupted) dt_us = 0;
    if (!app->interrupted && !app->map.wanted) view_fly_step(&app->fly, dt_us, app->client);
    c3d_camera camera = see(app, dt_us);
    int changed = ff_client_update(app->client, now_us, &camera);
    tell_what_fits_not(app);
    tell_layer(app);
    if (app->settling) watch_settling(app, changed);
    /* During an interruption the screen is not ours: the last picture stays. */
    int wanted = (changed && !app->interrupted) || app->redraw || app->screenshot ||
                 hud_changed(app, now_us);
    if (wanted) return draw(app) < 0 ? -1 : 1;
    return 0;
}

static int script_done(const view_app *app)
{
    const view_options *o = app->options;
    if (app->settling || app->screenshot) return 0;
    if (o->frames && app->frame >= o->frames) return 1;
    return !o->frames && (o->script || o->keys) && app->script.next == app->script.count;
}

int view_app_run(view_app *app)
{
    int scripted = app->options->script || app->options->keys, rc = 0;
    int64_t last_us = sys_time_us();
    while (!app->quit && !script_done(app)) {
        int64_t now_us = sys_time_us(), dt_us = now_us - last_us;
        last_us = now_us;
        if ((rc = turn(app, now_us,
                       scripted            ? SCRIPT_STEP_US
                       : dt_us < DT_US_MAX ? dt_us
                                           : DT_US_MAX)) < 0)
            return -1;
        int64_t frame_us = app->battery_low || app->interrupted ? FRAME_US_LOW_POWER
                           : rc                                 ? FRAME_US
                                                                : IDLE_SLEEP_US;
        int64_t left_us = frame_us - (sys_time_us() - now_us);
        if (left_us > 0) sys_sleep_us(left_us);
        if (!app->settling) app->frame++;
    }
    if (!app->options->screenshot) return 0;
    app->screenshot = app->options->screenshot;
    return draw(app);
}
