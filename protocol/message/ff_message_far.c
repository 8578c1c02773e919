/* GET_FAR and its answers, FAR; see SPEC.md, "Messages". Fins and paint are bytes here. */
#include "ff_message_local.h"

/* GET_FAR: id, position, front, heading, region, focal length, rows, shift, quality, tolerance,
 * count. */
#define FAR_BYTES (2 + 3 * 4 + 4 + 2 + 5 * 2 + 2 + 2 + 1 + 1 + 1 + 1)
FF_STATIC_ASSERT(FF_MESSAGE_HEADER_MAX + FAR_BYTES + FF_FAR_SECTORS <= FF_SHORT_BYTES_MAX);
/* A sector and its flags share a byte of FAR, as a face's do. */
FF_STATIC_ASSERT(FF_FAR_SECTORS <= 16);

static int sectors_ok(const ff_get_far *get)
{
    unsigned seen = 0;
    if (get->sector_count < 1 || get->sector_count > FF_FAR_SECTORS) return 0;
    for (unsigned i = 0; i < get->sector_count; i++) {
        if (get->sector[i] >= FF_FAR_SECTORS || (seen >> get->sector[i] & 1u)) return 0;
        seen |= 1u << get->sector[i];
    }
    return 1;
}

static int get_far_ok(const ff_get_far *get)
{
    return get->front_wu >= 0 && get->low_m <= get->high_m && get->focal >= FF_FAR_FOCAL_MIN &&
           get->focal <= FF_FAR_FOCAL_MAX && get->down >= 1 && get->down <= 2 * FF_FAR_FOCAL_MAX &&
           get->paint_shift <= FF_FAR_SHIFT_MAX && get->quality <= 100 &&
           (get->quality || get->tolerance_q2) && sectors_ok(get);
}

void ff_message_write_get_far(ff_writer *out, const ff_get_far *get)
{
    ff_message_require(&out->error, get_far_ok(get));
    ff_write_bytes(out, get->id, 2);
    for (int axis = 0; axis < 3; axis++) ff_write_bytes(out, (uint32_t)get->position_wu[axis], 4);
    ff_write_bytes(out, (uint32_t)get->front_wu, 4);
    ff_write_bytes(out, get->heading, 2);
    ff_write_bytes(out, get->behind_m, 2);
    ff_write_bytes(out, get->ahead_m, 2);
    ff_write_bytes(out, get->aside_m, 2);
    ff_write_bytes(out, (uint16_t)get->low_m, 2);
    ff_write_bytes(out, (uint16_t)get->high_m, 2);
    ff_write_bytes(out, get->focal, 2);
    ff_write_bytes(out, get->down, 2);
    ff_write_bytes(out, get->paint_shift, 1);
    ff_write_bytes(out, get->quality, 1);
    ff_write_bytes(out, get->tolerance_q2, 1);
    ff_write_bytes(out, get->sector_count, 1);
    if (out->error == FF_OK) ff_write_span(out, get->sector, get->sector_count);
}

void ff_message_read_get_far(ff_reader *in, ff_get_far *get)
{
    get->id = (uint16_t)ff_read_bytes(in, 2);
    for (int axis = 0; axis < 3; axis++) get->position_wu[axis] = (int32_t)ff_read_signed(in, 4);
    get->front_wu = (int32_t)ff_read_signed(in, 4);
    get->heading = (uint16_t)ff_read_bytes(in, 2);
    get->behind_m = (uint16_t)ff_read_bytes(in, 2);
    get->ahead_m = (uint16_t)ff_read_bytes(in, 2);
    get->aside_m = (uint16_t)ff_read_bytes(in, 2);
    get->low_m = (int16_t)ff_read_signed(in, 2);
    get->high_m = (int16_t)ff_read_signed(in, 2);
    get->focal = (uint16_t)ff_read_bytes(in, 2);
    get->down = (uint16_t)ff_read_bytes(in, 2);
    get->paint_shift = (uint8_t)ff_read_bytes(in, 1);
    get->quality = (uint8_t)ff_read_bytes(in, 1);
    get->tolerance_q2 = (uint8_t)ff_read_bytes(in, 1);
    get->sector_count = (uint8_t)ff_read_bytes(in, 1);
    for (unsigned i = 0; i < get->sector_count && i < FF_FAR_SECTORS; i++)
        get->sector[i] = (uint8_t)ff_read_bytes(in, 1);
    ff_message_require(&in->error, get_far_ok(get));
}

static int paint_ok(const ff_far *far)
{
    if (far->blocks_x == 0) return far->blocks_y == 0 && far->top == 0 && !far->paint_bytes;
    return far->blocks_x <= FF_FAR_BLOCKS_MAX && far->blocks_x % 2 == 0 && far->blocks_y > 0 &&
           far->paint_bytes > 0;
}

static int far_ok(const ff_far *far)
{
    int empty = far->fins_bytes == 0 && far->blocks_x == 0;
    return far->sector < FF_FAR_SECTORS && (far->flags & ~(FF_FACE_EMPTY | FF_FACE_LAST)) == 0 &&
           empty == ((far->flags & FF_FACE_EMPTY) != 0) && paint_ok(far);
}

void ff_message_write_far(ff_writer *out, const ff_far *far)
{
    ff_message_require(&out->error, far_ok(far));
    ff_write_bytes(out, far->sector | (uint32_t)far->flags << 4, 1);
    if (far->flags & FF_FACE_EMPTY) return;
    ff_write_varint(out, far->fins_bytes);
    ff_write_span(out, far->fins, far->fins_bytes);
    ff_write_bytes(out, far->blocks_x, 1);
    if (!far->blocks_x) return;
    ff_write_bytes(out, far->blocks_y, 1);
    ff_write_bytes(out, (uint16_t)far->top, 2);
    ff_write_span(out, far->paint, far->paint_bytes);
}

void ff_message_read_far(ff_reader *in, ff_far *far)
{
    uint8_t form = (uint8_t)ff_read_bytes(in, 1);
    far->sector = form & 15u;
    far->flags = form >> 4;
    if (!(far->flags & FF_FACE_EMPTY)) {
        far->fins_bytes = ff_read_varint(in);
        far->fins = ff_read_span(in, far->fins_bytes);
        far->blocks_x = (uint8_t)ff_read_bytes(in, 1);
    }
    if (far->blocks_x) {
        far->blocks_y = (uint8_t)ff_read_bytes(in, 1);
        far->top = (int16_t)ff_read_signed(in, 2);
        ff_message_read_rest(in, &far->paint, &far->paint_bytes);
    }
    ff_message_require(&in->error, far_ok(far));
}
