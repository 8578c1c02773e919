/* Sectors of far sets, decoded. Left out with them. */
#include "../ask/ff_intake_local.h"
#include "../ask/ff_texels.h"
#include "../../protocol/picture/ff_paint.h"
#include "../../protocol/ff_assert.h"

#include <string.h>

static unsigned power_of_two(unsigned least)
{
    unsigned size = 1;
    while (size < least) size *= 2;
    return size;
}

/* Rows of blocks for which there is room: a picture that is too high lacks its lowest, which are
 * the nearest ground. */
static unsigned rows_that_fit(const ff_intake *intake, const ff_far *far)
{
    size_t width = power_of_two(far->blocks_x * FF_FAR_BLOCK + 2u),
           texels = (intake->news->image_bytes - FF_NEW_FINS_BYTES) / sizeof(uint16_t);
    unsigned rows = far->blocks_y;
    while (rows && width * power_of_two(rows * FF_FAR_BLOCK + 2u) > texels) rows--;
    return rows;
}

/* Where blocks are laid: a texture with a texel of rim round it. */
typedef struct canvas {
    uint16_t *texel;
    unsigned width, rows; /* texels; rows of blocks that fit */
} canvas;

static void lay_block(void *context, unsigned column, unsigned row, uint8_t rgb[64][3])
{
    const canvas *on = context;
    if (row >= on->rows) return;
    uint16_t *to = on->texel + (size_t)(row * FF_FAR_BLOCK + 1) * on->width +
                   column * FF_FAR_BLOCK + 1;
    for (unsigned i = 0; i < 64; i++)
        to[i / FF_FAR_BLOCK * on->width + i % FF_FAR_BLOCK] = ff_texel_5551(rgb[i], 1);
}

static int decode_paint(ff_intake *intake, const ff_far *far, ff_new_item *item)
{
    unsigned rows = rows_that_fit(intake, far),
             width = power_of_two(far->blocks_x * FF_FAR_BLOCK + 2u),
             height = power_of_two(rows * FF_FAR_BLOCK + 2u);
    uint16_t *out = (uint16_t *)(void *)((uint8_t *)item->pixels + FF_NEW_FINS_BYTES);
    canvas on = { out, width, rows };
    const ff_paint_sink sink = { &on, lay_block };
    if (!rows || ff_paint_room_bytes(far->blocks_x) > intake->rgb_bytes) return FF_ERR_RANGE;
    memset(out, 0, (size_t)width * height * sizeof *out);
    int rc = ff_paint_decode(far->paint, far->paint_bytes, far->blocks_x, far->blocks_y,
                             (ff_paint_room *)(void *)intake->rgb, &sink);
    if (rc < 0) return rc;
    ff_texels_bleed(out, width, height);
    item->width = (uint16_t)width;
    item->height = (uint16_t)height;
    item->u.far.middle = (int16_t)(far->blocks_x * FF_FAR_BLOCK / 2 + 1);
    item->u.far.top = (int16_t)(far->top + 1);
    return FF_OK;
}

int ff_intake_far(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    const ff_far *far = &answer->u.far;
    FF_ASSERT(far->sector < FF_FAR_SECTORS); /* ff_message_decode lets no other pass */
    item->u.far.sector = far->sector;
    item->u.far.empty = (far->flags & FF_FACE_EMPTY) != 0;
    item->u.far.fins = 0;
    item->last = (far->flags & FF_FACE_LAST) != 0;
    item->width = item->height = 0;
    if (item->u.far.empty) return FF_OK;
    if (FF_NEW_FINS_BYTES > intake->news->image_bytes) return FF_ERR_RANGE;
    if (!ff_new_data_image(intake->news, item)) return FF_ERR_AGAIN;
    if (far->fins_bytes) {
        int count = ff_fins_decode(far->fins, far->fins_bytes,
                                   (ff_fin_vertex *)(void *)item->pixels, FF_FAR_VERTICES_MAX);
        if (count < 0) return count;
        item->u.far.fins = (uint16_t)count;
    }
    return far->blocks_x ? decode_paint(intake, far, item) : FF_OK;
}
