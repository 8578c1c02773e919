/* A drawn face as pixels: where its ground is, and an image that compresses well (Hybrid, section
 * 6.2). Pure functions. */
#ifndef FF_FACE_IMAGE_H
#define FF_FACE_IMAGE_H

#include "../../protocol/message/ff_message.h"

typedef struct ff_face_spans {
    uint16_t top_row, row_count; /* row_count 0: no ground at all */
    /* relative to top_row; equal where a column has none */
    uint16_t top[FF_FACE_SIZE_MAX], bottom[FF_FACE_SIZE_MAX];
} ff_face_spans;

/* Spans of ground in a size by size picture, RGB888, top row first. */
void ff_face_find_spans(const uint8_t *rgb, uint32_t size, ff_face_spans *spans);

/* Lowers the lower end of each span by a pixel, and to the lower ends beside it. There the near
 * plane has cut off ground that the client draws itself, in front of the face: rounding must leave
 * no gap between the two. */
void ff_face_lower(ff_face_spans *spans, uint32_t size);

/* Paints over all that is not ground within the spans' rows: ground is continued up, down, into
 * holes and sideways, so that neither coding nor filtering brings a foreign colour to its edge. */
void ff_face_fill(uint8_t *rgb, uint32_t size, const ff_face_spans *spans);

#endif
