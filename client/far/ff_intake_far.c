/* Sectors of far sets, decoded. Left out with them. */
#include "../ask/ff_intake_local.h"
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

/* Rounded: cut off, the whole picture would be darker. */
static unsigned of_31(unsigned of_255) { return (of_255 * 31 + 127) / 255; }

/* Lays the blocks that are there, one behind the other in `rgb`, into the picture, opaque; a texel
 * of rim round it and the blocks that are not there stay transparent. */
static void lay_blocks(const uint8_t *rgb, const uint8_t *there, unsigned blocks_x,
                       unsigned blocks_y, unsigned count, uint16_t *out, unsigned width)
{
    unsigned block = 0;
    for (unsigned i = 0; i < blocks_x * blocks_y; i++) {
        if (!there[i]) continue;
        uint16_t *to = out + (size_t)(i / blocks_x * FF_FAR_BLOCK + 1) * width +
                       i % blocks_x * FF_FAR_BLOCK + 1;
        FF_ASSERT(block < count);
        for (unsigned y = 0; y < FF_FAR_BLOCK; y++, to += width) {
            const uint8_t *from = rgb + 3 * ((size_t)y * count + block) * FF_FAR_BLOCK;
            for (unsigned x = 0; x < FF_FAR_BLOCK; x++, from += 3)
                to[x] = (uint16_t)(of_31(from[0]) << 11 | of_31(from[1]) << 6 |
                                   of_31(from[2]) << 1 | 1u);
        }
        block++;
    }
}

/* Gives transparent texels beside opaque ones their colour: filtering mixes both. */
static void bleed(uint16_t *texel, unsigned width, unsigned height)
{
    for (unsigned y = 0; y < height; y++)
        for (unsigned x = 0; x < width; x++) {
            uint16_t *here = texel + (size_t)y * width + x;
            if (*here & 1u) continue;
            uint16_t beside = 0;
            if (x > 0 && here[-1] & 1u)
                beside = here[-1];
            else if (x + 1 < width && here[1] & 1u)
                beside = here[1];
            else if (y > 0 && here[-(ptrdiff_t)width] & 1u)
                beside = here[-(ptrdiff_t)width];
            else if (y + 1 < height && here[width] & 1u)
                beside = here[width];
            *here = (uint16_t)(beside & ~1u);
        }
}

static int decode_paint(ff_intake *intake, const ff_far *far, ff_new_item *item)
{
    unsigned blocks = (unsigned)far->blocks_x * far->blocks_y, rows = rows_that_fit(intake, far),
             width = power_of_two(far->blocks_x * FF_FAR_BLOCK + 2u),
             height = power_of_two(rows * FF_FAR_BLOCK + 2u);
    size_t texels = (size_t)width * height;
    if (!rows || blocks > intake->rgb_bytes) return FF_ERR_RANGE;
    /* the list of blocks lies behind the decoded image */
    uint8_t *there = intake->rgb + intake->rgb_bytes - blocks;
    int count = ff_blocks_decode(far->blocks, far->blocks_bytes, there, blocks);
    if (count <= 0) return count < 0 ? count : FF_ERR_FORMAT;
    if ((size_t)count * FF_FAR_BLOCK * FF_FAR_BLOCK * 3 > intake->rgb_bytes - blocks)
        return FF_ERR_RANGE;
    int rc = sys_jpeg_decode(far->image, far->image_bytes, (unsigned)count * FF_FAR_BLOCK,
                             FF_FAR_BLOCK, intake->rgb);
    if (rc != FF_OK) return rc;
    uint16_t *out = (uint16_t *)(void *)((uint8_t *)item->pixels + FF_NEW_FINS_BYTES);
    memset(out, 0, texels * sizeof *out);
    lay_blocks(intake->rgb, there, far->blocks_x, rows, (unsigned)count, out, width);
    bleed(out, width, height);
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
