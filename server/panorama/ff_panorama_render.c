/* One face: bounds, ground, picture, spans, paint, message. */
#include "ff_panorama_render.h"
#include "ff_face_image.h"
#include "ff_face_view.h"
#include "../../protocol/picture/ff_paint.h"
#include "../ground/ff_pack_ground.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#define FACE_SIZE_MIN      16
#define SURFACE_SIZE_FIRST 256
#define COLUMNS_BYTES_MAX  (4 * FF_FACE_SIZE_MAX + 8)
#define IMAGE_BYTES_MAX    (FF_MESSAGE_BODY_MAX - COLUMNS_BYTES_MAX - 64)
#define BLOCKS_MAX         (FF_FACE_SIZE_MAX / FF_PAINT_BLOCK)
#define QUALITY_STEP       15
#define ERROR_PX_Q8        256 /* one texel of the face */

struct ff_panorama_renderer {
    const ff_pack *pack;
    const sys_surface_api *surface_api;
    const struct c3d_backend *backend;
    ff_panorama_render_stats stats;
    ff_pack_ground_stats drawn;

    /* The stage: made anew when a face larger than the surface is asked for. */
    uint16_t surface_size;
    sys_surface *surface;
    void *device_memory;
    c3d_device *device;
    ff_pack_ground ground;

    ff_face_spans spans;
    uint8_t *rgb;   /* surface_size^2 pixels */
    uint8_t *whole; /* likewise: what of them is coded, in whole blocks */
    ff_paint_room *room;
    uint8_t there[BLOCKS_MAX * BLOCKS_MAX];
    uint8_t columns[COLUMNS_BYTES_MAX];
    uint8_t image[IMAGE_BYTES_MAX];
};

/* ---- stage ---- */

static void stage_close(ff_panorama_renderer *renderer)
{
    if (renderer->surface) renderer->surface_api->make_current(renderer->surface);
    ff_pack_ground_close(&renderer->ground);
    if (renderer->device) c3d_close(renderer->device);
    if (renderer->surface) renderer->surface_api->close(renderer->surface);
    free(renderer->device_memory);
    free(renderer->rgb);
    free(renderer->whole);
    free(renderer->room);
    renderer->device = NULL;
    renderer->surface = NULL;
    renderer->device_memory = NULL;
    renderer->rgb = renderer->whole = NULL;
    renderer->room = NULL;
    renderer->surface_size = 0;
}

static int stage_try_open(ff_panorama_renderer *renderer, uint16_t size)
{
    enum sys_gl_kind gl = renderer->backend == c3d_backend_gles1() ? SYS_GL_ES1 : SYS_GL_DESKTOP;
    sys_surface_desc surface_desc = {
        .title = "panorama", .width = size, .height = size, .gl = gl
    };
    c3d_desc device_desc;
    int rc = renderer->surface_api->open(&surface_desc, &renderer->surface);
    if (rc < 0) {
        renderer->surface = NULL;
        return rc;
    }
    ff_pack_ground_desc(renderer->pack, renderer->surface_api, &device_desc);
    size_t bytes = c3d_bytes(renderer->backend, &device_desc);
    renderer->device_memory = malloc(bytes);
    renderer->rgb = malloc((size_t)3 * size * size);
    renderer->whole = malloc((size_t)3 * size * size);
    renderer->room = malloc(ff_paint_room_bytes(ff_face_blocks(size)));
    if (!renderer->device_memory || !renderer->rgb || !renderer->whole || !renderer->room)
        return FF_ERR_MEMORY;
    rc = c3d_open(renderer->backend, &device_desc, renderer->device_memory, bytes,
                  &renderer->device);
    if (rc < 0) {
        renderer->device = NULL;
        return rc;
    }
    renderer->surface_size = size;
    return ff_pack_ground_open(&renderer->ground, renderer->pack, renderer->device,
                               &renderer->drawn);
}

static int stage_open(ff_panorama_renderer *renderer, uint16_t size)
{
    int rc = stage_try_open(renderer, size);
    if (rc < 0) stage_close(renderer);
    return rc;
}

static int stage_fit(ff_panorama_renderer *renderer, uint16_t size)
{
    if (size <= renderer->surface_size)
        return renderer->surface_api->make_current(renderer->surface);
    uint16_t grown = SURFACE_SIZE_FIRST;
    while (grown < size) grown *= 2;
    stage_close(renderer);
    return stage_open(renderer, grown);
}

int ff_panorama_renderer_open(const ff_pack *pack, const sys_surface_api *surface_api,
                              const struct c3d_backend *backend, ff_panorama_renderer **renderer)
{
    *renderer = NULL;
    if (!surface_api || !backend) return FF_ERR_UNSUPPORTED;
    ff_panorama_renderer *opened = calloc(1, sizeof *opened);
    if (!opened) return FF_ERR_MEMORY;
    opened->pack = pack;
    opened->surface_api = surface_api;
    opened->backend = backend;
    int rc = stage_open(opened, SURFACE_SIZE_FIRST);
    if (rc < 0) {
        free(opened);
        return rc;
    }
    *renderer = opened;
    return FF_OK;
}

void ff_panorama_renderer_close(ff_panorama_renderer *renderer)
{
    if (!renderer) return;
    stage_close(renderer);
    free(renderer);
}

void ff_panorama_renderer_get_stats(const ff_panorama_renderer *renderer,
                                    ff_panorama_render_stats *stats)
{
    *stats = renderer->stats;
    stats->ground = renderer->drawn;
}

/* ---- a face ---- */

/* Whether any ground of the terrain can lie in the face: its box alone, nothing read. */
static int terrain_seen(const ff_terrain_info *info, const ff_frame *frame,
                        const ff_get_panorama *request, enum ff_face_name face)
{
    uint32_t top = (uint32_t)info->height_max + info->max_error;
    uint32_t bottom = info->height_min > info->max_error
                          ? (uint32_t)info->height_min - info->max_error
                          : 0;
    const int64_t height_wu[2] = { ff_height_wu(info, bottom),
                                   ff_height_wu(info, top > UINT16_MAX ? UINT16_MAX : top) };
    ff_box box = ff_shape_bounds(info, frame, height_wu, request->position_wu);
    return ff_face_sees_box(request, face, &box);
}

/* Blocks that show ground. */
static void mark_blocks(ff_panorama_renderer *renderer, unsigned size)
{
    const ff_face_spans *spans = &renderer->spans;
    unsigned columns = ff_face_blocks(size);
    memset(renderer->there, 0, (size_t)columns * ff_face_blocks(spans->row_count));
    for (unsigned c = 0; c < size; c++)
        for (unsigned row = spans->top[c]; row < spans->bottom[c]; row++)
            renderer->there[row / FF_PAINT_BLOCK * columns + c / FF_PAINT_BLOCK] = 1;
}

/* The spans' rows in whole blocks: beyond the last row and column stand those once more. */
static ff_paint_source take_rows(ff_panorama_renderer *renderer, unsigned size)
{
    const ff_face_spans *spans = &renderer->spans;
    unsigned columns = ff_face_blocks(size), rows = ff_face_blocks(spans->row_count);
    uint8_t *to = renderer->whole;
    for (unsigned y = 0; y < rows * FF_PAINT_BLOCK; y++) {
        unsigned row = spans->top_row + (y < spans->row_count ? y : spans->row_count - 1u);
        for (unsigned x = 0; x < columns * FF_PAINT_BLOCK; x++, to += 3)
            memcpy(to, renderer->rgb + 3 * ((size_t)row * size + (x < size ? x : size - 1)), 3);
    }
    mark_blocks(renderer, size);
    return (ff_paint_source){ columns, rows, renderer->there, renderer->whole };
}

static void look_away(void *context, unsigned column, unsigned row, uint8_t rgb[64][3])
{
    (void)context, (void)column, (void)row, (void)rgb;
}

/* The spans' rows at the wanted quality, or the best below it that fits a message. */
static int encode_image(ff_panorama_renderer *renderer, uint16_t size, int quality)
{
    static const ff_paint_sink nobody = { .block = look_away };
    const ff_paint_source source = take_rows(renderer, size);
    for (;; quality -= QUALITY_STEP) {
        int bytes = ff_paint_encode(&source, quality < 1 ? 1 : (unsigned)quality, renderer->room,
                                    &nobody, renderer->image, sizeof renderer->image);
        if (bytes != FF_ERR_FULL || quality < 1) return bytes;
    }
}

/* Draws and encodes into `face`; leaves it empty when no ground shows. FF_OK or an error. */
static int draw_face(ff_panorama_renderer *renderer, const ff_get_panorama *request,
                     const ff_ground_look *look, ff_face *face)
{
    ff_pack_ground_draw(&renderer->ground, look);
    int rc = c3d_read_rgb(renderer->device, renderer->rgb);
    if (rc < 0) return rc;
    ff_face_find_spans(renderer->rgb, request->face_size, &renderer->spans);
    if (renderer->spans.row_count == 0) {
        renderer->stats.empty_drawn++;
        return FF_OK;
    }
    ff_face_lower(&renderer->spans, request->face_size);
    ff_face_fill(renderer->rgb, request->face_size, &renderer->spans);
    int image_bytes = encode_image(renderer, request->face_size, request->quality);
    if (image_bytes < 0) return image_bytes;
    int columns_bytes = ff_face_columns_encode(renderer->spans.top, renderer->spans.bottom,
                                               request->face_size, renderer->columns,
                                               sizeof renderer->columns);
    if (columns_bytes < 0) return columns_bytes;
    face->flags &= (uint8_t)~FF_FACE_EMPTY;
    face->top_row = renderer->spans.top_row;
    face->row_count = renderer->spans.row_count;
    face->columns = renderer->columns;
    face->columns_bytes = (uint32_t)columns_bytes;
    face->image = renderer->image;
    face->image_bytes = (uint32_t)image_bytes;
    return FF_OK;
}

typedef struct face_look {
    const ff_get_panorama *request;
    enum ff_face_name face;
} face_look;

static int face_sees(const void *context, const ff_box *box)
{
    const face_look *of = context;
    return ff_face_sees_box(of->request, of->face, box);
}

/* O comes in world axes; from here on it is a point of the frame at O. */
static int render_face(ff_panorama_renderer *renderer, const ff_get_panorama *asked, ff_face *face)
{
    const ff_terrain_info *info = &renderer->pack->header.info;
    ff_frame frame = ff_shape_frame(info, asked->position_wu);
    ff_get_panorama entered = *asked, *request = &entered;
    ff_shape_enter(info, &frame, asked->position_wu, request->position_wu);
    if (!terrain_seen(info, &frame, request, face->face)) {
        renderer->stats.empty_by_bounds++;
        return FF_OK;
    }
    int rc = stage_fit(renderer, request->face_size);
    if (rc < 0) return rc;
    face_look of = { request, face->face };
    ff_ground_look look = { .frame = frame,
                            .view_wu = request->back_wu,
                            .hole_wu = ff_face_near_wu(request),
                            .error_px_q8 = ERROR_PX_Q8,
                            .layer = request->layer,
                            .sees = face_sees,
                            .context = &of };
    ff_face_camera(request, face->face, &look.camera);
    ff_pack_ground_load(&renderer->ground, &look);
    if (!ff_pack_ground_seen(&renderer->ground, &look)) {
        renderer->stats.empty_by_bounds++;
        return FF_OK;
    }
    return draw_face(renderer, request, &look, face);
}

int ff_panorama_render_face(ff_panorama_renderer *renderer, const ff_get_panorama *request,
                            uint8_t face, int last, uint8_t *out, size_t capacity)
{
    if (face >= FF_FACE_COUNT || request->face_size < FACE_SIZE_MIN ||
        request->face_size > FF_FACE_SIZE_MAX || request->front_wu < 8 ||
        request->back_wu <= request->front_wu)
        return FF_ERR_RANGE;
    ff_message message = { .type = FF_MSG_ANSWER, .kind = FF_KIND_FACE };
    message.u.face = (ff_face){ .id = request->id,
                                .face = face,
                                .face_size = request->face_size,
                                .flags = (uint8_t)(FF_FACE_EMPTY | (last ? FF_FACE_LAST : 0)) };
    int64_t start_us = sys_time_us();
    int rc = render_face(renderer, request, &message.u.face);
    if (rc == FF_OK) rc = ff_message_encode(&message, out, capacity);
    renderer->stats.faces++;
    renderer->stats.time_us += sys_time_us() - start_us;
    if (rc > 0) renderer->stats.bytes += (uint64_t)rc;
    return rc;
}
