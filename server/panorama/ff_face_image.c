#include "ff_face_image.h"

#include <assert.h>
#include <string.h>

static int is_ground(const uint8_t *pixel)
{
    return !(pixel[0] == 255 && pixel[1] == 0 && pixel[2] == 255);
}

static uint8_t *pixel_at(uint8_t *rgb, uint32_t size, uint32_t column, uint32_t row)
{
    return rgb + 3 * ((size_t)row * size + column);
}

void ff_face_find_spans(const uint8_t *rgb, uint32_t size, ff_face_spans *spans)
{
    assert(size <= FF_FACE_SIZE_MAX);
    uint32_t first = size, end = 0;
    memset(spans, 0, sizeof *spans);
    for (uint32_t row = 0; row < size; row++)
        for (uint32_t c = 0; c < size; c++)
            if (is_ground(rgb + 3 * ((size_t)row * size + c))) {
                if (spans->bottom[c] == 0) spans->top[c] = (uint16_t)row;
                spans->bottom[c] = (uint16_t)(row + 1);
                first = row < first ? row : first;
                end = row + 1;
            }
    if (end == 0) return;
    spans->top_row = (uint16_t)first;
    spans->row_count = (uint16_t)(end - first);
    for (uint32_t c = 0; c < size; c++)
        if (spans->bottom[c]) {
            spans->top[c] = (uint16_t)(spans->top[c] - first);
            spans->bottom[c] = (uint16_t)(spans->bottom[c] - first);
        }
}

void ff_face_lower(ff_face_spans *spans, uint32_t size)
{
    if (spans->row_count == 0) return;
    if (spans->top_row + spans->row_count < (int)size) spans->row_count++;
    uint16_t before = 0; /* of the column to the left, as it was */
    for (uint32_t c = 0; c < size; c++) {
        uint16_t here = spans->bottom[c], after = c + 1 < size ? spans->bottom[c + 1] : 0;
        uint16_t lowest = before > here ? before : here;
        lowest = (uint16_t)((after > lowest ? after : lowest) + 1);
        before = here;
        if (spans->top[c] < here)
            spans->bottom[c] = lowest < spans->row_count ? lowest : spans->row_count;
    }
}

/* The nearest column with ground; there is one. */
static uint32_t nearest_column(const ff_face_spans *spans, uint32_t size, uint32_t column)
{
    for (uint32_t away = 0; away < size; away++) {
        if (column >= away && spans->top[column - away] < spans->bottom[column - away])
            return column - away;
        if (column + away < size && spans->top[column + away] < spans->bottom[column + away])
            return column + away;
    }
    assert(!"a face with rows has a column with ground");
    return column;
}

static void fill_column(uint8_t *rgb, uint32_t size, const ff_face_spans *spans, uint32_t c)
{
    uint8_t last[3];
    memcpy(last, pixel_at(rgb, size, c, spans->top_row + spans->top[c]), 3);
    for (uint32_t row = spans->top_row; row < (uint32_t)spans->top_row + spans->row_count; row++) {
        uint8_t *pixel = pixel_at(rgb, size, c, row);
        if (is_ground(pixel))
            memcpy(last, pixel, 3);
        else
            memcpy(pixel, last, 3);
    }
}

void ff_face_fill(uint8_t *rgb, uint32_t size, const ff_face_spans *spans)
{
    if (spans->row_count == 0) return;
    for (uint32_t c = 0; c < size; c++)
        if (spans->top[c] < spans->bottom[c]) fill_column(rgb, size, spans, c);
    for (uint32_t c = 0; c < size; c++) {
        if (spans->top[c] < spans->bottom[c]) continue;
        uint32_t from = nearest_column(spans, size, c);
        for (uint32_t row = spans->top_row; row < (uint32_t)spans->top_row + spans->row_count;
             row++)
            memcpy(pixel_at(rgb, size, c, row), pixel_at(rgb, size, from, row), 3);
    }
}
