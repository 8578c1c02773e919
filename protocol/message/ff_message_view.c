/* GET_VIEW; see SPEC.md, "Messages". */
#include "ff_message_local.h"

/* GET_VIEW, the longest of requests: id, angles, position, focal length, size, measure, depth,
 * error allowed, reach, fine, coarse, triangles, bytes, count. */
#define VIEW_BYTES (2 + 3 * 2 + 3 * 4 + 4 + 2 * 2 + 1 + 1 + 4 + 4 + 4 + 1 + 5 + 5 + 1 + 1)
FF_STATIC_ASSERT(FF_MESSAGE_HEADER_MAX + VIEW_BYTES +
                     (FF_VIEW_KEYS_MAX + FF_VIEW_EDGE_MAX) * FF_MESSAGE_KEY_BYTES <=
                 FF_REQUEST_BYTES_MAX);
FF_STATIC_ASSERT(FF_VIEW_KEYS_MAX <= 16); /* bits of `roots` */

enum { NAMES_ROOT, NAMES_REFINEMENT };

static int view_ok(const ff_get_view *view)
{
    if (view->focal_q8 < 256 || view->width < 1 || view->width > FF_VIEW_SIDE_MAX ||
        view->height < 1 || view->height > FF_VIEW_SIDE_MAX || view->measure > FF_VIEW_BY_PIXELS ||
        view->depth_max > FF_KEY_LEVEL_MAX + 1 || view->allowed_q8 < 1 || view->reach_wu < 1 ||
        view->fine_wu < 1 || view->coarse < 1 || view->coarse > FF_VIEW_COARSE_MAX ||
        view->count > FF_VIEW_KEYS_MAX || view->roots >> view->count != 0 ||
        view->edge_count > (view->count ? FF_VIEW_EDGE_MAX : 0))
        return 0;
    for (unsigned i = 0; i < view->edge_count; i++)
        if (!ff_message_get_ok(&(ff_get){ .key = view->edge[i] }, FF_KIND_REFINEMENT)) return 0;
    for (unsigned i = 0; i < view->count; i++) {
        const ff_get get = { .key = view->below[i] };
        if (!ff_message_get_ok(&get, view->roots >> i & 1u ? FF_KIND_ROOT : FF_KIND_REFINEMENT))
            return 0;
    }
    return 1;
}

/* 1 when it refines that node, or one below it. */
static int is_below(ff_key top, enum ff_kind kind, ff_key key)
{
    uint32_t above = ff_key_level(top), level = ff_key_level(key);
    return kind == FF_KIND_REFINEMENT && ff_key_tile(top) == ff_key_tile(key) && level >= above &&
           ff_key_code(key) >> 2 * (level - above) == ff_key_code(top);
}

int ff_view_covers(const ff_get_view *view, enum ff_kind kind, ff_key key)
{
    FF_ASSERT(kind == FF_KIND_ROOT || kind == FF_KIND_REFINEMENT);
    if (view->count == 0) return 1;
    for (unsigned i = 0; i < view->count; i++)
        if (view->roots >> i & 1u ? ff_key_tile(view->below[i]) == ff_key_tile(key)
                                  : is_below(view->below[i], kind, key))
            return 1;
    for (unsigned i = 0; i < view->edge_count; i++)
        if (is_below(view->edge[i], kind, key)) return 1;
    return 0;
}

uint32_t ff_view_names(const ff_get_view *view, enum ff_kind kind, ff_key key)
{
    uint32_t named = 0;
    FF_ASSERT(kind == FF_KIND_ROOT || kind == FF_KIND_REFINEMENT);
    for (unsigned i = 0; i < view->count; i++)
        if (view->below[i] == key && (kind == FF_KIND_ROOT) == (view->roots >> i & 1u))
            named |= 1u << i;
    return named;
}

void ff_message_write_view(ff_writer *out, const ff_get_view *view)
{
    ff_message_require(&out->error, view_ok(view));
    ff_write_bytes(out, view->id, 2);
    ff_write_bytes(out, view->yaw, 2);
    ff_write_bytes(out, view->pitch, 2);
    ff_write_bytes(out, view->roll, 2);
    for (int axis = 0; axis < 3; axis++) ff_write_bytes(out, (uint32_t)view->position_wu[axis], 4);
    ff_write_bytes(out, (uint32_t)view->focal_q8, 4);
    ff_write_bytes(out, view->width, 2);
    ff_write_bytes(out, view->height, 2);
    ff_write_bytes(out, view->measure, 1);
    ff_write_bytes(out, view->depth_max, 1);
    ff_write_bytes(out, (uint32_t)view->allowed_q8, 4);
    ff_write_bytes(out, (uint32_t)view->reach_wu, 4);
    ff_write_bytes(out, (uint32_t)view->fine_wu, 4);
    ff_write_bytes(out, view->coarse, 1);
    ff_write_varint(out, view->triangles_max);
    ff_write_varint(out, view->bytes_max);
    ff_write_bytes(out, view->count, 1);
    for (unsigned i = 0; out->error == FF_OK && i < view->count; i++)
        ff_message_write_key(out, view->roots >> i & 1u ? NAMES_ROOT : NAMES_REFINEMENT,
                             view->below[i]);
    ff_write_bytes(out, view->edge_count, 1);
    for (unsigned i = 0; out->error == FF_OK && i < view->edge_count; i++)
        ff_message_write_key(out, NAMES_REFINEMENT, view->edge[i]);
}

void ff_message_read_view(ff_reader *in, ff_get_view *view)
{
    view->id = (uint16_t)ff_read_bytes(in, 2);
    view->yaw = (uint16_t)ff_read_bytes(in, 2);
    view->pitch = (uint16_t)ff_read_bytes(in, 2);
    view->roll = (uint16_t)ff_read_bytes(in, 2);
    for (int axis = 0; axis < 3; axis++) view->position_wu[axis] = (int32_t)ff_read_signed(in, 4);
    view->focal_q8 = (int32_t)ff_read_signed(in, 4);
    view->width = (uint16_t)ff_read_bytes(in, 2);
    view->height = (uint16_t)ff_read_bytes(in, 2);
    view->measure = (uint8_t)ff_read_bytes(in, 1);
    view->depth_max = (uint8_t)ff_read_bytes(in, 1);
    view->allowed_q8 = (int32_t)ff_read_signed(in, 4);
    view->reach_wu = (int32_t)ff_read_signed(in, 4);
    view->fine_wu = (int32_t)ff_read_signed(in, 4);
    view->coarse = (uint8_t)ff_read_bytes(in, 1);
    view->triangles_max = ff_read_varint(in);
    view->bytes_max = ff_read_varint(in);
    view->count = (uint8_t)ff_read_bytes(in, 1);
    ff_message_require(&in->error, view->count <= FF_VIEW_KEYS_MAX);
    for (unsigned i = 0; in->error == FF_OK && i < view->count; i++) {
        uint32_t form = (uint32_t)ff_read_bytes(in, 1), what = form & 15u;
        ff_message_require(&in->error, what <= NAMES_REFINEMENT);
        if (what == NAMES_ROOT) view->roots |= (uint16_t)(1u << i);
        view->below[i] = ff_message_read_key(in, form);
    }
    view->edge_count = (uint8_t)ff_read_bytes(in, 1);
    ff_message_require(&in->error, view->edge_count <= FF_VIEW_EDGE_MAX);
    for (unsigned i = 0; in->error == FF_OK && i < view->edge_count; i++) {
        uint32_t form = (uint32_t)ff_read_bytes(in, 1);
        ff_message_require(&in->error, (form & 15u) == NAMES_REFINEMENT);
        view->edge[i] = ff_message_read_key(in, form);
    }
    ff_message_require(&in->error, view_ok(view));
}
