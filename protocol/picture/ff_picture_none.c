/* Stands in for builds without pictures: ground is drawn in its colours, or by JPEGs. */
#include "ff_paint.h"

const uint8_t ff_picture_built = 0;

int ff_picture_decode(const uint8_t *bytes, size_t count, unsigned log2, ff_picture_above above,
                      ff_picture_room *room, uint8_t *rgb)
{
    (void)bytes, (void)count, (void)log2, (void)above, (void)room, (void)rgb;
    return FF_ERR_UNSUPPORTED;
}

int ff_picture_decode_row(const uint8_t *bytes, size_t count, unsigned log2, unsigned levels,
                          uint32_t code, ff_picture_room *room, uint8_t *rgb, uint8_t *spare)
{
    (void)bytes, (void)count, (void)log2, (void)levels, (void)code, (void)room, (void)rgb,
        (void)spare;
    return FF_ERR_UNSUPPORTED;
}

int ff_paint_decode(const uint8_t *bytes, size_t count, unsigned columns, unsigned rows,
                    ff_paint_room *room, const ff_paint_sink *sink)
{
    (void)bytes, (void)count, (void)columns, (void)rows, (void)room, (void)sink;
    return FF_ERR_UNSUPPORTED;
}
