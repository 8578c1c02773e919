#include "view_hud.h"

#include "../../common3d/c3d_text.h"
#include "view_app.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define MARGIN_PX   4
#define SHADE       150 /* opacity of the ground behind the text, of 255 */
#define TEXT_COLOUR 0xffffffffu
#define ABOUT_LINES 6
#define LARGE_PX    900 /* windows this high get text twice as large */

static const char help[] = "w s a d   fly (or up, down)\n"
                           "left right  turn\n"
                           "pgup pgdn   height\n"
                           "shift     five times faster\n"
                           "enter     cruise   space stop\n"
                           "drag      look     scroll speed\n"
                           "+ -       quality\n"
/* clang-format off */
#define X(NAME, option, key, name, help) key " " name "\n"
                           FF_SHOW_MODES(X)
#undef X
    /* clang-format on */
    "p far ground  l link\n"
    "i images  n map  c contours\n"
    "h text   k pools\n"
    "r start   esc quit\n"
    "f1 help   f2 position fix\n"
    "f3 tilt   f4 touch\n"
    "f5 battery low / ok\n"
    "f6 interruption   f12 picture\n";

static void put(view_hud *hud, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void put(view_hud *hud, const char *format, ...)
{
    size_t used = strlen(hud->text);
    va_list args;
    va_start(args, format);
    vsnprintf(hud->text + used, sizeof hud->text - used, format, args);
    va_end(args);
}

static void put_link(view_hud *hud, const view_app *app, const ff_client_stats *stats)
{
    static const char *const state[] = { "local", "connecting", "up", "down" };
    put(hud, "link %s%s%s", app->link ? view_link_name(app->link) : "", app->link ? " " : "",
        state[stats->link]);
    if (app->link)
        put(hud, "  %.1f kB/s rtt %u ms", stats->bandwidth_bytes_s / 1000.0, stats->rtt_ms);
    if (stats->refusal && !stats->have_terrain) put(hud, "  %s", ff_error_text(stats->refusal));
    put(hud, "\n%.1f kB down %.1f kB up\nqueue %u in flight %u\n", (double)stats->bytes_down / 1000,
        (double)stats->bytes_up / 1000, stats->queued, stats->in_flight);
}

static void put_quality(view_hud *hud, const view_app *app, const ff_client_stats *stats)
{
    int32_t position_wu[3];
    unsigned faces = 0, count = 0;
    if (app->options->balance.mode != FF_BALANCE_OFF)
        put(hud, "share %u%% fidelity %u%% to %.1f km\n", stats->balance.share_percent,
            stats->balance.fidelity_percent,
            (stats->back_plane_wu ? stats->back_plane_wu : stats->quality.view_wu) / 256000.0);
    if (app->quality.measure == FF_MEASURE_PIXELS)
        put(hud, "px %.2f", stats->quality.error_px_q8 / 256.0);
    else
        put(hud, "c %.2f depth %u", stats->quality.c_q8 / 256.0, stats->quality.depth_max);
    put(hud, "  error about %.1f px\n", ff_client_error_px_q8(app->client) / 256.0);
    if (stats->tree.stubs) put(hud, "nothing finer of %u nodes\n", stats->tree.stubs);
    if (app->far.enabled && stats->link != FF_LINK_NONE) {
        put(hud, "far %s %u sets %.1f kB\n", sim_far_words[app->far.enabled], stats->far_sets,
            stats->far_bytes / 1000.0);
        return;
    }
    if (!app->panorama.enabled) {
        put(hud, "panorama off\n");
        return;
    }
    if (ff_client_panorama(app->client, position_wu, &faces))
        for (; faces; faces &= faces - 1) count++;
    put(hud, "panorama%s %u faces %.1f kB\n",
        app->panorama.enabled == FF_PANORAMA_AUTO ? " auto" : "", count,
        stats->panorama_bytes / 1000.0);
}

/* In use, the most so far, and room, of each pool of the block that has any. */
static void put_pools(view_hud *hud, const view_app *app)
{
    ff_pool_use pool[FF_POOLS_MAX];
    unsigned count = ff_client_pools(app->client, pool);
    put(hud, "%-16s%7s%7s%7s\n", "pool", "now", "most", "of");
    for (unsigned i = 0; i < count; i++)
        if (pool[i].count)
            put(hud, "%s%-*s%7u%7u%7u\n", pool[i].inside ? " " : "", pool[i].inside ? 15 : 16,
                pool[i].name, pool[i].held, pool[i].high, pool[i].count);
}

/* Pixels of the window to one of the text's. */
static int scale_of(const view_app *app) { return app->fly.camera.height >= LARGE_PX ? 2 : 1; }

static void put_about(view_hud *hud, const view_app *app)
{
    char lines[ABOUT_LINES * (VIEW_HUD_SIZE / C3D_TEXT_ADVANCE_PX + 1) + 1];
    int width = app->fly.camera.width / scale_of(app);
    if (width > VIEW_HUD_SIZE) width = VIEW_HUD_SIZE;
    unsigned columns = (unsigned)(width - 2 * MARGIN_PX) / C3D_TEXT_ADVANCE_PX;
    if (sim_about_lines(app->client, columns, ABOUT_LINES, lines, sizeof lines))
        put(hud, "%s", lines);
}

static void put_figures(view_hud *hud, const view_app *app)
{
    ff_client_stats stats;
    const c3d_camera *camera = &app->fly.camera;
    ff_client_get_stats(app->client, &stats);
    if (!stats.have_terrain)
        put(hud, "%s\n", app->options->target);
    else
        put(hud, "%u triangles  %u/%u nodes\n", stats.tree.triangles, stats.tree.nodes_drawn,
            stats.tree.nodes_held);
    put_link(hud, app, &stats);
    put_quality(hud, app, &stats);
    char where[80];
    if (sim_where_line(&app->where, camera, where, sizeof where)) put(hud, "%s\n", where);
    put(hud, "%.2f %.2f km  %d m  %d deg\n", camera->pos_wu[0] / 256000.0,
        camera->pos_wu[1] / 256000.0, camera->pos_wu[2] / FF_WU_PER_METRE,
        camera->yaw * 360 / 65536);
    put(hud, "%d km/h%s\n", app->fly.speed_wu_s * 36 / (10 * FF_WU_PER_METRE),
        app->fly.cruise ? " cruise" : "");
    if (!app->show_help) put_about(hud, app);
    if (app->interrupted) put(hud, "interrupted\n");
    if (stats.low_power) put(hud, "low power\n");
}

/* What stands under the text while the map is shown: a scale, and an arrow to the north. */
#define BAND_PX 22
#define BAR_PX  120 /* the longest, of the window */

static void put_map(view_hud *hud, const view_app *app)
{
    uint32_t metres;
    const view_map *map = &app->map;
    hud->bar_px = 0;
    if (!view_map_shown(map)) return;
    hud->bar_px = (int)ff_map_bar(map->px_wu_q8, BAR_PX, &metres) / scale_of(app);
    hud->north = -map->map.yaw;
    if (metres >= 1000)
        put(hud, "%u km", metres / 1000);
    else
        put(hud, "%u m", metres);
    put(hud, "  contours %d m  up is %d deg\n", map->told.contour_wu / FF_WU_PER_METRE,
        (map->map.yaw & 65535) * 360 / 65536);
}

int view_hud_update(view_hud *hud, const view_app *app)
{
    hud->text[0] = 0;
    if (app->show_pools)
        put_pools(hud, app);
    else if (app->show_hud)
        put_figures(hud, app);
    if (app->show_help) put(hud, "\n%s", help);
    put_map(hud, app);
    return strcmp(hud->text, hud->shown) != 0;
}

static void set_pixel(view_hud *hud, int x, int y)
{
    if (x < 0 || y < 0 || x >= VIEW_HUD_SIZE || y >= VIEW_HUD_SIZE) return;
    memset(hud->rgba + 4 * (y * VIEW_HUD_SIZE + x), 0xFF, 4);
}

/* A bar with ticks at its ends, and beside it an arrow: a line with a blob at its head. */
static void paint_band(view_hud *hud, int top)
{
    int x0 = MARGIN_PX, y = top + BAND_PX / 2, middle = x0 + BAR_PX + BAND_PX;
    for (int x = 0; x <= hud->bar_px; x++)
        for (int k = 0; k < 2; k++) set_pixel(hud, x0 + x, y + k);
    for (int k = -4; k < 4; k++) {
        set_pixel(hud, x0, y + k);
        set_pixel(hud, x0 + hud->bar_px, y + k);
    }
    int32_t east = c3d_sin_q30(hud->north), north = c3d_cos_q30(hud->north);
    for (int k = -9; k <= 9; k++) {
        int x = middle + (int)((int64_t)k * east >> 30), down = y - (int)((int64_t)k * north >> 30);
        for (int i = 0; i < (k > 5 ? 9 : 1); i++)
            set_pixel(hud, x + (k > 5 ? i % 3 - 1 : 0), down + (k > 5 ? i / 3 - 1 : 0));
    }
}

/* A dark ground as high as the text, then its lines. */
static void paint(view_hud *hud)
{
    int rows = MARGIN_PX;
    for (const char *c = hud->text; *c; c++) rows += *c == '\n' ? C3D_TEXT_LINE_PX : 0;
    int top = rows;
    if (hud->bar_px) rows += BAND_PX;
    memset(hud->rgba, 0, sizeof hud->rgba);
    for (int i = 0; i < rows * VIEW_HUD_SIZE && i < VIEW_HUD_SIZE * VIEW_HUD_SIZE; i++)
        hud->rgba[4 * i + 3] = SHADE;
    c3d_text(hud->rgba, VIEW_HUD_SIZE, VIEW_HUD_SIZE, MARGIN_PX, MARGIN_PX, TEXT_COLOUR, hud->text);
    if (hud->bar_px) paint_band(hud, top);
    memcpy(hud->shown, hud->text, sizeof hud->shown);
}

void view_hud_draw(view_hud *hud, const view_app *app, c3d_device *device)
{
    const ff_terrain_info *info = ff_client_terrain(app->client);
    uint32_t checksum = info ? info->checksum : 0;
    int size = scale_of(app) * VIEW_HUD_SIZE;
    /* another terrain has another device: the texture went with the old one */
    if (device != hud->device || checksum != hud->checksum) hud->texture.id = 0;
    hud->device = device;
    hud->checksum = checksum;
    if (view_hud_update(hud, app) || !hud->texture.id) {
        if (hud->texture.id) c3d_texture_free(device, hud->texture);
        paint(hud);
        hud->texture = c3d_texture_make(device, C3D_RGBA8888, VIEW_HUD_SIZE, VIEW_HUD_SIZE,
                                        hud->rgba);
    }
    c3d_overlay(device, hud->texture, 0, 0, size, size);
    c3d_end(device);
}
