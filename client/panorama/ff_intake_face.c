/* Faces of a panorama, decoded. Left out with panoramas. */
#include "../ask/ff_intake_local.h"
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

/* Converts the face's rows to RGBA5551, lowest row first, padded upwards; only texels within the
 * column spans are opaque. The padding's first row has the colours of the image's top row, because
 * filtering mixes both: black would draw a dark line along the horizon. */
static void to_rgba5551(const uint8_t *rgb, unsigned width, unsigned rows, const uint16_t *top,
                        const uint16_t *bottom, unsigned height, uint16_t *out)
{
    FF_ASSERT(rows <= height && height <= width);
    for (unsigned r = 0; r < rows; r++) {
        unsigned row = rows - 1 - r;
        const uint8_t *from = rgb + (size_t)row * width * 3;
        for (unsigned i = 0; i < width; i++, from += 3) {
            unsigned opaque = row >= top[i] && row < bottom[i];
            *out++ = (uint16_t)((from[0] >> 3 << 11) | (from[1] >> 3 << 6) | (from[2] >> 3 << 1) |
                                opaque);
        }
    }
    for (unsigned i = 0; rows < height && i < width; i++, out++)
        *out = (uint16_t)(out[-(ptrdiff_t)width] & ~1u);
    if (rows + 1 < height) memset(out, 0, (size_t)(height - rows - 1) * width * sizeof *out);
}

static int decode_face(ff_intake *intake, const ff_face *face, ff_new_item *item)
{
    unsigned size = face->face_size;
    if (size > intake->face_size_max || (size & (size - 1)) != 0 || face->row_count == 0 ||
        face->row_count > size || face->top_row + face->row_count > size)
        return FF_ERR_RANGE;
    FF_ASSERT((size_t)size * face->row_count * 3 <= intake->rgb_bytes);
    uint16_t *top = intake->columns, *bottom = intake->columns + size;
    int rc = ff_face_columns_decode(face->columns, face->columns_bytes, size, face->row_count, top,
                                    bottom);
    if (rc == FF_OK)
        rc = sys_jpeg_decode(face->image, face->image_bytes, size, face->row_count, intake->rgb);
    if (rc != FF_OK) return rc;
    item->width = (uint16_t)size;
    item->height = (uint16_t)texture_rows(face->row_count);
    FF_ASSERT((size_t)size * item->height * sizeof *item->pixels <= intake->news->image_bytes);
    item->u.face.top_row = face->top_row;
    item->u.face.row_count = face->row_count;
    to_rgba5551(intake->rgb, size, face->row_count, top, bottom, item->height, item->pixels);
    return FF_OK;
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
