/* Faces of a panorama, decoded. Left out with panoramas. */
#include "../ask/ff_intake_local.h"
#include "../ask/ff_texels.h"
#include "../../protocol/picture/ff_paint.h"
#include "../../protocol/ff_assert.h"

#include <string.h>

/* Power of two at least `rows`. */
static unsigned texture_rows(unsigned rows)
{
    unsigned height = 1;
    FF_ASSERT(rows > 0 && rows <= FF_FACE_SIZE_MAX);
    while (height < rows) height *= 2;
    return height;
}

/* Where blocks are laid: lowest row first, padded upwards; only texels within the column spans are
 * opaque. */
typedef struct canvas {
    uint16_t *texel;
    unsigned size, rows;
    const uint16_t *top, *bottom;
} canvas;

static void lay_block(void *context, unsigned column, unsigned row, uint8_t rgb[64][3])
{
    const canvas *on = context;
    for (unsigned i = 0; i < 64; i++) {
        unsigned x = column * FF_PAINT_BLOCK + i % FF_PAINT_BLOCK,
                 y = row * FF_PAINT_BLOCK + i / FF_PAINT_BLOCK;
        if (x >= on->size || y >= on->rows) continue;
        unsigned opaque = y >= on->top[x] && y < on->bottom[x];
        on->texel[(size_t)(on->rows - 1 - y) * on->size + x] = ff_texel_5551(rgb[i], opaque);
    }
}

static int decode_image(ff_intake *intake, const ff_face *face, canvas *on, unsigned height)
{
    const ff_paint_sink sink = { on, lay_block };
    unsigned blocks_x = ff_face_blocks(face->face_size), blocks_y = ff_face_blocks(face->row_count);
    if (ff_paint_room_bytes(blocks_x) > intake->rgb_bytes) return FF_ERR_RANGE;
    memset(on->texel, 0, (size_t)face->face_size * height * sizeof *on->texel);
    int rc = ff_paint_decode(face->image, face->image_bytes, blocks_x, blocks_y,
                             (ff_paint_room *)(void *)intake->rgb, &sink);
    if (rc < 0) return rc;
    ff_texels_bleed(on->texel, face->face_size, height);
    return FF_OK;
}

static int decode_face(ff_intake *intake, const ff_face *face, ff_new_item *item)
{
    unsigned size = face->face_size;
    if (size > intake->face_size_max || (size & (size - 1)) != 0 || face->row_count == 0 ||
        face->row_count > size || face->top_row + face->row_count > size)
        return FF_ERR_RANGE;
    uint16_t *top = intake->columns, *bottom = intake->columns + size;
    canvas on = { item->pixels, size, face->row_count, top, bottom };
    item->width = (uint16_t)size;
    item->height = (uint16_t)texture_rows(face->row_count);
    item->u.face.top_row = face->top_row;
    item->u.face.row_count = face->row_count;
    FF_ASSERT((size_t)size * item->height * sizeof *item->pixels <= intake->news->image_bytes);
    int rc = ff_face_columns_decode(face->columns, face->columns_bytes, size, face->row_count, top,
                                    bottom);
    return rc == FF_OK ? decode_image(intake, face, &on, item->height) : rc;
}

int ff_intake_face(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    const ff_face *face = &answer->u.face;
    FF_ASSERT(face->face < FF_FACE_COUNT); /* ff_message_decode lets no other pass */
    item->u.face.face = face->face;
    item->u.face.empty = (face->flags & FF_FACE_EMPTY) != 0;
    item->last = (face->flags & FF_FACE_LAST) != 0;
    if (item->u.face.empty) return FF_OK;
    if (!ff_new_data_image(intake->news, item)) return FF_ERR_AGAIN;
    return decode_face(intake, face, item);
}
