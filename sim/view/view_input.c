/* Events: flying keys to the pilot, letters to switches, function keys to injected device events,
 * all events to the client. */
#include "view_app.h"

#define FIX_AHEAD_WU  (500 * FF_WU_PER_METRE)
#define TOUCH_PX      40
#define QUALITY_STEPS 4 /* + and - change by a quarter */

static void log_event(view_app *app, const sys_event *event)
{
    FILE *out = app->events;
    app->events_handled++;
    if (!out) return;
    fprintf(out, "%u ", app->frame);
    switch (event->type) {
        case SYS_EVENT_KEY:
            fprintf(out, "key %s %s\n", view_key_name(event->u.key.code),
                    event->u.key.down ? "down" : "up");
            break;
        case SYS_EVENT_POINTER:
            fprintf(out, "pointer %d %d %d\n", (int)event->u.pointer.action, event->u.pointer.x,
                    event->u.pointer.y);
            break;
        case SYS_EVENT_RESIZE:
            fprintf(out, "resize %d %d\n", event->u.resize.width, event->u.resize.height);
            break;
        case SYS_EVENT_POSITION:
            fprintf(out, "position %d %d %d\n", event->u.position.x_wu / FF_WU_PER_METRE,
                    event->u.position.y_wu / FF_WU_PER_METRE,
                    event->u.position.z_wu / FF_WU_PER_METRE);
            break;
        case SYS_EVENT_ACCELEROMETER:
            fprintf(out, "accelerometer %d %d %d\n", event->u.accelerometer.x_mg,
                    event->u.accelerometer.y_mg, event->u.accelerometer.z_mg);
            break;
        case SYS_EVENT_BATTERY:
            fprintf(out, "battery %s\n", event->u.battery.low ? "low" : "ok");
            break;
        case SYS_EVENT_INTERRUPTION:
            fprintf(out, "interruption %s\n", event->u.interruption.begins ? "begin" : "end");
            break;
        case SYS_EVENT_QUIT: fputs("quit\n", out); break;
        case SYS_EVENT_NONE: fputs("none\n", out); break;
    }
    fflush(out);
}

/* ---- function keys: what a device would report ---- */
static void inject_pointer(enum sys_pointer_action action, int x, int y)
{
    sys_event event = { .type = SYS_EVENT_POINTER,
                        .time_us = sys_time_us(),
                        .u.pointer = { action, x, y, 0 } };
    sys_event_inject(&event);
}

static void inject(view_app *app, int function_key)
{
    sys_event event = { .time_us = sys_time_us() };
    const c3d_camera *camera = &app->fly.camera;
    switch (function_key) {
        case 2: /* a fix half a kilometre ahead */
            event.type = SYS_EVENT_POSITION;
            event.u.position.x_wu = camera->pos_wu[0] +
                                    c3d_mul_q30(FIX_AHEAD_WU, c3d_sin_q30(camera->yaw));
            event.u.position.y_wu = camera->pos_wu[1] +
                                    c3d_mul_q30(FIX_AHEAD_WU, c3d_cos_q30(camera->yaw));
            event.u.position.z_wu = camera->pos_wu[2];
            event.u.position.accuracy_wu = 10 * FF_WU_PER_METRE;
            break;
        case 3: /* held upright, leant back by 30 degrees, and so on */
            app->tilted = !app->tilted;
            event.type = SYS_EVENT_ACCELEROMETER;
            event.u.accelerometer.y_mg = app->tilted ? 866 : 1000;
            event.u.accelerometer.z_mg = app->tilted ? 500 : 0;
            break;
        case 4: /* a finger drags to the right */
            inject_pointer(SYS_POINTER_DOWN, camera->width / 2, camera->height / 2);
            inject_pointer(SYS_POINTER_MOVE, camera->width / 2 + TOUCH_PX, camera->height / 2);
            inject_pointer(SYS_POINTER_UP, camera->width / 2 + TOUCH_PX, camera->height / 2);
            return;
        case 5:
            event.type = SYS_EVENT_BATTERY;
            event.u.battery.low = !app->battery_low;
            event.u.battery.percent = event.u.battery.low ? 5 : 80;
            break;
        case 6:
            event.type = SYS_EVENT_INTERRUPTION;
            event.u.interruption.begins = !app->interrupted;
            break;
        default: return;
    }
    sys_event_inject(&event);
}

/* ---- switches ---- */
/* Switches a way to draw; 1 when the key is that of one. */
static int toggle_show(view_app *app, int code)
{
    unsigned bit = 0;
#define X(NAME, option, key, name, help) \
    if (code == (key)[0]) bit = FF_SHOW_##NAME;
    FF_SHOW_MODES(X)
#undef X
    app->show ^= bit;
    if (bit) ff_client_set_show(app->client, app->show);
    return bit != 0;
}

void view_set_quality(view_app *app)
{
    ff_quality quality = app->quality;
    if (app->map_quality) {
        quality.measure = FF_MEASURE_PIXELS;
        quality.error_px_q8 = FF_MAP_ERROR_PX_Q8;
        quality.depth_max = 0;
        quality.triangles_max = ff_map_triangles(app->fly.camera.width, app->fly.camera.height);
    }
    ff_client_set_quality(app->client, &quality);
}

static void change_quality(view_app *app, int finer)
{
    ff_quality *quality = &app->quality;
    int32_t *value = quality->measure == FF_MEASURE_PIXELS ? &quality->error_px_q8 : &quality->c_q8;
    /* a larger C is finer, more pixels of error are coarser */
    int more = finer == (quality->measure == FF_MEASURE_DISTANCE);
    int64_t changed = more ? (int64_t)*value * (QUALITY_STEPS + 1) / QUALITY_STEPS + 1
                           : (int64_t)*value * QUALITY_STEPS / (QUALITY_STEPS + 1);
    if (changed < 16 || changed > 256 * 256) return;
    *value = (int32_t)changed;
    view_set_quality(app);
}

static void start_again(view_app *app)
{
    app->fly.placed = 0; /* the loop places the pilot anew */
    app->fly.camera.yaw = app->options->yaw_brad16;
    app->fly.camera.roll = 0;
}

/* Far ground: by sets where they pay, by panoramas where they do, by panoramas, by the client. */
static void next_far(view_app *app)
{
    uint8_t *sets = &app->far.enabled, *panorama = &app->panorama.enabled;
    if (*sets)
        *sets = FF_FAR_OFF, *panorama = FF_PANORAMA_AUTO;
    else if (*panorama == FF_PANORAMA_AUTO)
        *panorama = FF_PANORAMA_ON;
    else if (*panorama == FF_PANORAMA_ON)
        *panorama = FF_PANORAMA_OFF;
    else
        *sets = FF_FAR_AUTO;
    ff_client_set_far(app->client, &app->far);
    ff_client_set_panorama(app->client, &app->panorama);
}

/* The next layer of images; behind the last one none. */
static void next_layer(view_app *app)
{
    int shown = ff_client_layer(app->client);
    const char *name = ff_client_layer_name(app->client, shown < 0 ? 0 : (unsigned)shown + 1);
    if (shown != FF_ERR_AGAIN) (void)ff_client_set_layer(app->client, name);
}

static void press(view_app *app, int code)
{
    static char path[64];
    switch (code) {
        case 'p': next_far(app); break;
        case 'i': next_layer(app); break;
        case 'n':
            app->fly.dragging = 0; /* a finger that is down moves neither any more */
            view_map_toggle(&app->map, &app->fly, app->client, 1);
            break;
        case 'c': app->map.contours = !app->map.contours; break;
        case 'l':
            if (app->link) view_link_cycle(app->link);
            break;
        case 'h': app->show_hud = !app->show_hud; break;
        case 'k': app->show_pools = !app->show_pools; break;
        case 'r': start_again(app); break;
        case '+':
        case '=': change_quality(app, 1); break;
        case '-': change_quality(app, 0); break;
        case SYS_KEY_ENTER: app->fly.cruise = !app->fly.cruise; break;
        case SYS_KEY_SPACE: view_fly_release(&app->fly); break;
        case SYS_KEY_ESCAPE: app->quit = 1; break;
        case SYS_KEY_F1: app->show_help = !app->show_help; break;
        case SYS_KEY_F1 + 11:
            snprintf(path, sizeof path, "farfield-view-%u.png", ++app->screenshots);
            app->screenshot = path;
            break;
        default:
            if (toggle_show(app, code)) break;
            inject(app, code - SYS_KEY_F1 + 1);
            return;
    }
    app->redraw = 1;
}

static void handle_device(view_app *app, const sys_event *event)
{
    switch (event->type) {
        case SYS_EVENT_POSITION:
            view_fly_position(&app->fly, event->u.position.x_wu, event->u.position.y_wu,
                              event->u.position.z_wu);
            break;
        case SYS_EVENT_ACCELEROMETER:
            view_fly_tilt(&app->fly, event->u.accelerometer.x_mg, event->u.accelerometer.y_mg,
                          event->u.accelerometer.z_mg);
            break;
        case SYS_EVENT_BATTERY: app->battery_low = event->u.battery.low != 0; break;
        case SYS_EVENT_INTERRUPTION:
            app->interrupted = event->u.interruption.begins != 0;
            view_fly_release(&app->fly);
            break;
        default: return;
    }
    app->redraw = 1;
}

void view_handle(view_app *app, const sys_event *event)
{
    log_event(app, event);
    ff_client_event(app->client, event);
    switch (event->type) {
        case SYS_EVENT_QUIT: app->quit = 1; break;
        case SYS_EVENT_RESIZE:
            /* the soft back end's memory is for one size: its picture is stretched over the window
             */
            if (app->backend == c3d_backend_soft()) {
                app->blit.window_width = event->u.resize.width;
                app->blit.window_height = event->u.resize.height;
            } else {
                view_fly_resize(&app->fly, event->u.resize.width, event->u.resize.height);
                if (app->map_quality) view_set_quality(app); /* its triangles go by the window */
            }
            app->redraw = 1;
            break;
        case SYS_EVENT_KEY:
            if (!view_fly_key(&app->fly, event->u.key.code, event->u.key.down) && event->u.key.down)
                press(app, event->u.key.code);
            break;
        case SYS_EVENT_POINTER:
            if (app->map.wanted)
                view_map_pointer(&app->map, event->u.pointer.action, event->u.pointer.x,
                                 event->u.pointer.y, event->u.pointer.button);
            else
                view_fly_pointer(&app->fly, event->u.pointer.action, event->u.pointer.x,
                                 event->u.pointer.y, event->u.pointer.button);
            break;
        default: handle_device(app, event); break;
    }
}
