/* Farfield: the embedding API. One header for a program that wants to show terrain.
 *
 *   static unsigned char block[4 << 20];
 *   ff_client_desc desc = {0};                    // zero means the default, see each field
 *   desc.memory = block; desc.memory_bytes = sizeof block;
 *   desc.stream = &stream;               // or desc.pack = &pack: a terrain on this device
 *   desc.backend = c3d_backend_gles1();  // or soft; NULL: geometry only, no pictures
 *   desc.surface_api = sys_surface_egl();
 *   ff_client *client; int rc = ff_client_create(&desc, &client);
 *   each frame:
 *       ff_client_work(client, now_us);           // or desc.use_thread = 1, and a thread does it
 *       if (ff_client_update(client, now_us, &camera)) ff_client_draw(client);   // then present
 *
 * Rules
 *   1. Everything lives in the block; nothing is allocated after ff_client_create, except by
 *      zlib/libjpeg inside platform/ calls.
 *   2. All calls come from one thread (the one that owns the GL context); only ff_client_work may
 *      come from another one.
 *   3. Time is the caller's: microseconds that never go back. Camera as in common3d/c3d.h: position
 *      in 1/256 m from the terrain's south-west corner, angles in 1/65536 turn. near_wu and far_wu
 *      of the camera may be 0: fitted to what is drawn.
 *   4. The picture may lag behind the link, never break: what has not arrived is drawn coarser.
 */
#ifndef FARFIELD_H
#define FARFIELD_H

#ifdef __cplusplus
extern "C" {
#endif

#include "ff_figures.h"
#include "map/ff_map.h"
#include "terrain/ff_tree.h"
#include "../protocol/far/ff_far.h"
#include "../protocol/ff_pack.h"
#include "../protocol/geo/ff_geo.h"

#define FARFIELD_VERSION "0.1.0"

/* Bounds of what ff_client_create takes; options of programs have their ranges from here. */
#define FF_PICTURE_SIDE_MAX     4096
#define FF_PANORAMA_BACK_WU_MAX (8000000 * 256) /* of back_plane_wu: 8000 km */
#define FF_PANORAMA_FACE_MIN    64 /* the largest is FF_FACE_SIZE_MAX of ff_message.h */
#define FF_FAR_COARSE_MAX       16
#define FF_QUALITY_C_MAX        1000
#define FF_QUALITY_ERROR_PX_MAX 1000
#define FF_QUALITY_DEPTH_MAX    16 /* all levels of a key */

/* What a client takes where no quality is given: pixels of error, and pixels of the picture for
 * each triangle. */
#define FF_QUALITY_DEFAULT_PX     2
#define FF_QUALITY_DEFAULT_PIXELS 14
#define FF_QUALITY_BUDGET_PX      1 /* with a frame budget, which then limits the triangles */

typedef struct ff_client ff_client;

/* Who draws far ground: the client all of it up to quality.view_wu; panoramas what lies beyond
 * back_plane_wu; or whichever is cheaper for the error allowed (panorama/ff_panorama_auto.h). */
enum ff_panorama_use { FF_PANORAMA_OFF, FF_PANORAMA_ON, FF_PANORAMA_AUTO };

/* One who answers: a server or a pack on this device, mapped or read, with at most
 * FF_WELCOME_GROUNDS packs joined. The other is NULL. */
typedef struct ff_source_desc {
    const ff_pack *pack;
    sys_stream *stream;
} ff_source_desc;

/* Zero in any field takes the default given. */
typedef struct ff_panorama_desc {
    uint8_t enabled; /* enum ff_panorama_use; default FF_PANORAMA_OFF */
    /* the client draws ground itself up to here, and here a panorama begins: z_back_c = z_front_s
     * of Hybrid; default 7500 m */
    int32_t back_plane_wu;
    int32_t server_back_wu; /* how far a panorama reaches: z_back_s; default: to the horizon */
    /* epsilon of Hybrid eq. 6, 7 and 13 in pixels of the screen, default 5 % of its half-width */
    int32_t error_px_q8;
    uint16_t face_size; /* default 256 */
    uint8_t quality;    /* of the faces, as of paint; default 80 */
    /* 0 (default): at most one set is asked for at a time; 1: a new set is asked for as soon as the
     * last is outdated, whatever is still on its way (Hybrid's congestion flag) */
    uint8_t hold_back;
} ff_panorama_desc;

/* What stands in for fine far ground (client/far): nothing; fins, the outlines of ridges; fins and
 * paint, their colours; or what pays, by far/ff_far_rule.h. */
enum ff_far_use { FF_FAR_OFF, FF_FAR_FINS, FF_FAR_PAINT, FF_FAR_AUTO };

/* Far ground as a coarse tree with sets of fins and paint on it, taken by the server. Not together
 * with panoramas: where sets are used those are off. Zero in any field takes the default given. */
typedef struct ff_far_desc {
    uint8_t enabled;  /* enum ff_far_use; default FF_FAR_OFF */
    uint8_t no_paint; /* 1: fins at most, as for a display of two colours */
    /* from here on, measured as back_plane_wu, or from four fifths of how high the camera is above
     * ground, if that is more; FF_FAR_AUTO may choose half to twice as far; default 7500 m */
    int32_t front_wu;
    /* ground beyond may be so many times as wrong as quality allows, up to 16; default 4 */
    uint8_t coarse;
    uint8_t paint_shift;  /* texels of paint are 2^this as large as pixels, 0 to 3 */
    uint8_t quality;      /* of the paint, 1 to 100; default 80, wider than 320 pixels 84 */
    uint8_t tolerance_q2; /* quarter pixels that a fin may be off; default 2 */
} ff_far_desc;

/* The work follows what a frame may cost and what the link carries (client/balance/ff_balance.h),
 * between the limits given here (coarsest) and the quality and panorama set (finest). A frame's
 * budget moves the limit of triangles; the link moves a bound on detail and the panorama's error.
 * Zero in any field takes the default given. */
enum ff_balance_mode {
    FF_BALANCE_OFF,
    FF_BALANCE_ON,
    /* no controller: FF_TRIANGLES_MIN up to the nearest back plane, the rest is panorama */
    FF_BALANCE_ALL_SERVER,
    /* no controller: as set as far as quality.view_wu, no panoramas */
    FF_BALANCE_ALL_CLIENT
};

typedef struct ff_balance_desc {
    enum ff_balance_mode mode;
    /* what a frame may cost. Triangles: no picture has more. Or in the unit of
     * ff_client_frame_cost: then the limit of triangles is moved so that costs stay below it, 9 %
     * may pass. 0: no limit but the quality's */
    uint32_t frame_budget;
    /* bytes that may come in a second; 0: only link_percent limits them */
    uint32_t link_bytes_s;
    /* share that may be used of what the link is found to carry, and share of the time in which
     * something in view may wait for the link; default 80 */
    uint8_t link_percent;
    int32_t c_min_q8;        /* FF_MEASURE_DISTANCE; default a quarter of quality.c_q8 */
    int32_t error_px_max_q8; /* FF_MEASURE_PIXELS; default eight times quality.error_px_q8 */
    /* FF_BALANCE_ALL_SERVER, at most panorama.back_plane_wu; default a quarter of it */
    int32_t back_plane_min_wu;
    int32_t panorama_error_max_q8; /* default four times panorama.error_px_q8 */
} ff_balance_desc;

typedef struct ff_balance_stats {
    /* where the limit of triangles stands between FF_TRIANGLES_MIN and the one set, in log2 units:
     * 0 all server, 100 all client */
    uint8_t share_percent;
    uint8_t fidelity_percent; /* 100 as set, less to spare the link */
    /* log2(cost / budget) as last measured, Q8; above 0: over budget */
    int32_t frame_load_q8, link_load_q8;
    /* moves: how often a level changed; turns: how often against the direction of its last change
     */
    uint32_t moves, turns;
} ff_balance_stats;

#define FF_FIRST_ANSWER_MS_MAX 30000u

typedef struct ff_client_desc {
    void *memory;
    size_t memory_bytes; /* at least ff_client_bytes_min(); more memory holds finer ground */
    sys_stream *stream;  /* to a server; or NULL */
    const ff_pack *pack; /* a pack on this device instead, mapped or read; or NULL */
    /* More packs and servers, drawn together with that one, whose place on its ground is the
     * client's frame. One of the same ground (the same pack, or parts cut from it) is asked for
     * what those named before it lack; others are grounds of their own in the same reference
     * system: where they lie over each other the finer is shown, else the one named first.
     * While that one is a server not heard yet, a pack here that is a part of another is drawn, in
     * its own frame: the server's, if it has the whole. */
    const ff_source_desc *more;
    unsigned more_count;                /* at most FF_SOURCES_MAX - 1: ff_tree.h */
    const struct c3d_backend *backend;  /* NULL: no pictures */
    const sys_surface_api *surface_api; /* its context is current */
    /* viewport, default 240x320; a back end without a GL draws nothing in a larger one */
    uint16_t width, height;
    /* of a back end without a GL: C3D_RGB565 (0, default) or C3D_RGBA8888 */
    uint8_t frame_format;
    /* all zero: FF_QUALITY_DEFAULT_PX pixels of error, a triangle for FF_QUALITY_DEFAULT_PIXELS
     * pixels at most. Else C = 3, 2 pixels, sigma 1.25, as far as one sees, a triangle for 2 pixels
     * at most, where a field is zero */
    ff_quality quality;
    ff_panorama_desc panorama;
    ff_far_desc far;
    ff_balance_desc balance;
    uint8_t use_thread;       /* 1: ff_client_create starts a thread that calls ff_client_work */
    uint8_t use_plain_arrays; /* 1: no vertex buffers */
    uint8_t use_map;          /* 1: room for what ff_client_set_map draws, some 5 KB */
    /* 1: cameras given before a terrain is known are places on it already, as of a device that
     * knows which ground it is on: what they show is asked for with the greeting, a round trip
     * earlier */
    uint8_t place_known;
    /* How the viewer moves over ground as the client starts, wu a second, as a satellite receiver
     * tells it, and how long a first answer is likely to take, from the kind of the link or from
     * the last time (ff_client_stats.rtt_ms), at most FF_FIRST_ANSWER_MS_MAX. What goes out with
     * the greeting is then what shows when it comes: on a link of seconds the viewer is somewhere
     * else by then. 0: not known. */
    int32_t velocity_wu_s[2];
    uint32_t first_answer_ms;
    uint8_t no_textures; /* 1: images of the terrain are not asked for */
    const char *layer;   /* of images that is shown, as ff_client_set_layer; NULL: the first */
    uint8_t no_views;    /* 1: ground is asked for level by level, not for a view at once */
    /* 1: the server hands out all levels of its ground, however near quality.view_wu ends (SPEC.md,
     * "Entry") */
    uint8_t no_entry;
    uint8_t no_prefetch;   /* 1: what motion and turns will show is not asked for ahead */
    uint8_t no_reserve;    /* 1: neither ground nor fins all round while the link idles */
    enum ff_hidden hidden; /* default: ground that nearer ground hides is left out */
    /* what is to be known of what the pack says of itself (protocol/ff_about.h): FF_ABOUT_BIT of
     * each entry; a server is asked for those alone, and they have room in the block. Default:
     * nothing */
    uint32_t about;
    /* requests sent and unanswered at most, default 48; 32 in less than 1 MB */
    uint16_t in_flight_max;
    /* A connection silent this long with requests out is closed and made anew, default 60000. Never
     * shorter than four round trips, and doubled up to four times while no answer has ever come. */
    uint32_t answer_timeout_ms;
} ff_client_desc;

enum ff_link_state {
    FF_LINK_NONE, /* local pack */
    FF_LINK_CONNECTING,
    FF_LINK_UP,
    FF_LINK_DOWN /* retrying */
};

/* One row of ff_figures.h a field; the rows say what each counts. */
typedef struct ff_client_stats {
#define FIELD(type, name, from, what) type name;
#define PART(name, member)
    FF_CLIENT_FIGURES(FIELD, FIELD, PART)
#undef FIELD
#undef PART
} ff_client_stats;

/* A pool of the block, see ff_budget.h. */
typedef struct ff_pool_use {
    const char *name;
    uint32_t count;      /* of its items; 0: this client needs none */
    size_t bytes;        /* of all of them together */
    uint8_t inside;      /* lies inside the pool before it that is not inside another one */
    uint32_t held, high; /* in use now, and the most ever at once */
} ff_pool_use;
#define FF_POOLS_MAX 28

size_t ff_client_bytes_min(void);
/* FF_OK or FF_ERR_ARGUMENT, FF_ERR_MEMORY, FF_ERR_UNSUPPORTED, and errors of the pack. */
int ff_client_create(const ff_client_desc *desc, ff_client **client);
void ff_client_destroy(ff_client *client);

/* The network worker's step: sends, receives, decodes; never blocks. Returns 1 when it did
 * something, 0 when idle. */
int ff_client_work(ff_client *client, int64_t now_us);
/* Takes in new data and selects for this camera. 1: the picture changed, draw; 0: same picture as
 * before. Until the terrain is known the picture is the sky. */
int ff_client_update(ff_client *client, int64_t now_us, const c3d_camera *camera);
/* Draws the last update through the back end (no present). */
void ff_client_draw(ff_client *client);

/* Device events; what does not concern the client is ignored. Battery low or an interruption (a
 * call): C and triangles halved, pixels of error doubled, no prefetch, no reserve, no new
 * panoramas; an interruption also asks for nothing new, the link is just kept alive. Restored
 * after. */
void ff_client_event(ff_client *client, const sys_event *event);

/* Settings that may change between frames. When panoramas or far sets are switched on and the block
 * was shared out without them, the client gives up the terrain, shares the block out anew and asks
 * for the ground again. A face_size that ff_client_create would refuse becomes the nearest that it
 * takes.
 */
void ff_client_set_quality(ff_client *client, const ff_quality *quality);
void ff_client_set_panorama(ff_client *client, const ff_panorama_desc *panorama);
void ff_client_set_far(ff_client *client, const ff_far_desc *far); /* on: panoramas go off */
/* Shows another layer of the images that lie over the ground, by its name: "" the first, NULL none.
 * From now on only its images are asked for and drawn; heights stay as they are. Images of the one
 * before stay in the memory of those that are not in use, and are there again if it is shown again
 * soon. FF_OK; FF_ERR_NOT_FOUND: no source has a layer of that name, and nothing changes (before a
 * terrain is known it is remembered, and no images are shown when it turns out to be missing). */
int ff_client_set_layer(ff_client *client, const char *name);
/* The number of the layer that is shown of the first source, or FF_ERR_NOT_FOUND: none is, or there
 * is none of that name; FF_ERR_AGAIN: no terrain is known. */
int ff_client_layer(const ff_client *client);
/* The name of a layer of the first source, or NULL: it has fewer. One without a name is "". */
const char *ff_client_layer_name(const ff_client *client, unsigned number);
/* New budgets and limits, or on and off. Share and fidelity stay where they are on their ladders
 * and move from there. */
void ff_client_set_balance(ff_client *client, const ff_balance_desc *balance);
/* What the frame just drawn cost, in the unit of balance.frame_budget: microseconds, instructions.
 * From the first call on it stands in for the triangles counted by the client. 0: triangles
 * again. */
void ff_client_frame_cost(ff_client *client, uint32_t cost);
/* Ways to draw, besides the plain one; any of them together. The one list: a mode is a row here and
 * what client/ground/ff_show.c makes of it. X(NAME, option, key and name in farfield-view's help,
 * option's help) */
/* clang-format off */
#define FF_SHOW_MODES(X) \
    X(WIREFRAME, "wireframe", "m", "mesh", "the strips as lines, stitching strips in another colour") \
    X(NODE_BORDERS, "borders", "b", "node borders", "the nodes' borders as lines") \
    X(NO_FOG, "no-fog", "f", "fog", "far ground as clear as near ground") \
    X(FILLED, "filled", "v", "filled voids", "a mesh over ground that the source did not have, filled from around it")
#define X(NAME, option, key, name, help) FF_SHOW_INDEX_##NAME,
enum ff_show_index { FF_SHOW_MODES(X) };
#undef X
#define X(NAME, option, key, name, help) FF_SHOW_##NAME = 1 << FF_SHOW_INDEX_##NAME,
enum ff_show { FF_SHOW_MODES(X) };
#undef X
/* clang-format on */
/* `show`: bits of enum ff_show. */
void ff_client_set_show(ff_client *client, unsigned show);

/* What a map has over its ground (client/map/ff_map.h makes its camera, scale and interval); a
 * flight may have it, too. */
typedef struct ff_map_show {
    int32_t contour_wu;  /* contours lie so far apart in height; 0: none */
    int32_t place_wu[3]; /* the viewer's, as a camera's: a point is drawn there */
    uint8_t has_place;
} ff_map_show;
/* From the next picture on. FF_OK; FF_ERR_UNSUPPORTED: without desc.use_map or a back end, or not
 * built; FF_ERR_ARGUMENT: contours less than FF_CONTOUR_WU_MIN apart. */
#define FF_CONTOUR_WU_MIN 64
int ff_client_set_map(ff_client *client, const ff_map_show *map);

/* NULL until the terrain is known. */
const ff_terrain_info *ff_client_terrain(const ff_client *client);
/* An entry of what the pack says of itself, of those in desc.about: its bytes in `value`, a text
 * without an end mark; FF_ERR_AGAIN: it has not come yet; FF_ERR_NOT_FOUND: the pack does not say;
 * FF_ERR_FULL: `value` is too small; of a local pack what is wrong with it. */
int ff_client_about(ff_client *client, enum ff_about_entry entry, void *value, size_t room);
/* The same of one of several sources: 0 the first, 1 the first of desc.more. All of their
 * attributions are to be shown. */
int ff_client_source_about(ff_client *client, unsigned source, enum ff_about_entry entry,
                           void *value, size_t room);
/* Where on Earth the client's frame lies, for ff_geo_of, ff_geo_to and ff_geo_north
 * (protocol/geo/ff_geo.h); desc.about has to have FF_ABOUT_BIT(FF_ABOUT_PROJECTION). Worth asking
 * once for a terrain. FF_OK; FF_ERR_AGAIN: it is not known yet; FF_ERR_NOT_FOUND: the ground does
 * not say; FF_ERR_UNSUPPORTED: it is projected by another method, or the build has no geo;
 * FF_ERR_RANGE: what it says is no projection. */
int ff_client_geo(ff_client *client, ff_geo *geo);
/* FF_OK, or why a source gives nothing: FF_ERR_AGAIN, its server has not answered yet;
 * FF_ERR_UNSUPPORTED: its ground has no reference system in common with the first one's, or nodes
 * of another size; FF_ERR_RANGE: it lies too far away; FF_ERR_FULL. */
int ff_client_source_state(const ff_client *client, unsigned source);
const ff_tree *ff_client_tree(const ff_client *client);
/* For checks and the emulator: the c3d device; NULL without a back end and where the block has no
 * room for one. Until the terrain is known it is one for the sky; another one with every
 * terrain. */
c3d_device *ff_client_device(ff_client *client);
/* Ground height at (x, y) as drawn now: 1 and *z_wu, or 0 where no ground is drawn: beyond the
 * terrain's last sample there is none, and else it has not come or lies further than the client
 * draws. */
int ff_client_ground(const ff_client *client, int32_t x_wu, int32_t y_wu, int32_t *z_wu);
/* 1 where that ground may be made up: the source had voids there, and they were filled from around
 * them. It is told of whole nodes, finer where finer ground is drawn. 0: measured, or no ground. */
int ff_client_filled(const ff_client *client, int32_t x_wu, int32_t y_wu);
void ff_client_get_stats(const ff_client *client, ff_client_stats *stats);
/* The client's own estimate of its picture's error: pixels Q8 that 95 % of the pixels that show
 * ground likely do not pass; the picture's diagonal until the terrain is known. It is worked out
 * anew in every call, from some hundred places. */
uint32_t ff_client_error_px_q8(const ff_client *client);
/* The pools of the block and their number; those of a terrain have no items while none is known. */
unsigned ff_client_pools(const ff_client *client, ff_pool_use list[FF_POOLS_MAX]);
/* How a block of desc->memory_bytes would be shared out for a terrain, without the block: number of
 * pools, or FF_ERR_MEMORY. */
int ff_client_plan(const ff_client_desc *desc, const ff_terrain_info *info,
                   ff_pool_use list[FF_POOLS_MAX]);

/* 1 when the last update's picture shows this image of the ground somewhere. */
int ff_client_wears(const ff_client *client, ff_key image);

/* The panorama in use: 1 and where it was taken, or 0. *faces: bit per enum ff_face_name held
 * (empty ones included). */
int ff_client_panorama(const ff_client *client, int32_t position_wu[3], unsigned *faces);

/* The far set in use: 1, or 0. */
typedef struct ff_far_in_use {
    ff_key set;             /* its number, which rises from set to set */
    int32_t position_wu[3]; /* O, where it was taken, in the client's frame */
    int32_t world_wu[3];    /* the same as it was asked for */
    unsigned sectors;       /* bit per sector that is here and that the last picture may show */
} ff_far_in_use;
int ff_client_far(const ff_client *client, ff_far_in_use *use);
/* For checks: who is told, from now on, of fins that come: part by part, each a strip of triangles
 * as it is drawn, its places relative to its set's O, wu. The arrays are gone afterwards. */
typedef void (*ff_fins_made)(void *context, ff_key set, unsigned sector, const c3d_vertex *vertex,
                             uint32_t vertices, const uint16_t *index, uint32_t indices);
void ff_client_watch_fins(ff_client *client, ff_fins_made made, void *context);

/* 1 while the request of this id on the wire, or where it has none (0) of this kind and node, is
 * out and was made for the reserve. For checks, from the thread that calls ff_client_work. */
int ff_client_asked_for_reserve(ff_client *client, enum ff_kind kind, uint16_t id, ff_key key);

/* FNV-1a hash over what is drawn (keys, border masks, heights, origins) and another one over
 * requests made, since the start: the same on every back end. */
uint64_t ff_client_geometry_hash(const ff_client *client);
uint64_t ff_client_request_hash(const ff_client *client);

#ifdef __cplusplus
}
#endif

#endif
