/* The new-data list: decoded answers on their way from the network worker to the main thread, first
 * in first out. One producer (worker), one consumer (main thread). A full list stops the worker
 * from receiving: nothing is thrown away. Items and images live in the client's block; an image
 * slot is taken only by items that carry pixels. */
#ifndef FF_NEW_DATA_H
#define FF_NEW_DATA_H

#include "ff_request.h"

typedef struct ff_new_item {
    ff_key key;
    uint16_t id;            /* of the request */
    uint8_t kind;           /* enum ff_kind */
    uint8_t last;           /* ends its request (a panorama's other faces do not) */
    int32_t error;          /* FF_OK or why there is no answer */
    ff_residuals residuals; /* roots and refinements; values belong to the item */
    /* Textures: RGB565, width x width, row 0 south. Faces: RGBA5551 of width x height (a power of
     * two), row 0 lowest, texels without ground transparent. */
    uint16_t *pixels; /* NULL: no image */
    uint16_t width, height;
    uint8_t face, face_empty;
    uint16_t face_top_row, face_row_count;
    uint32_t bytes; /* of the message, for the counters */
} ff_new_item;

typedef struct ff_new_data {
    sys_mutex mutex; /* guards head, count, image_count */
    ff_new_item *item;
    uint8_t *images; /* image_slots of image_bytes each */
    size_t image_bytes;
    uint16_t item_slots, image_slots;
    uint16_t head, count, high;
    uint16_t image_head, image_count, image_high;
} ff_new_data;

/* In use now, and the most at once. */
typedef struct ff_new_data_counts {
    uint16_t items, items_high, images, images_high;
} ff_new_data_counts;

/* Bytes of items with `values` residuals each. */
size_t ff_new_data_item_bytes(unsigned item_slots, unsigned values);
void ff_new_data_init(ff_new_data *list, unsigned item_slots, unsigned values, void *items,
                      unsigned image_slots, size_t image_bytes, void *images);

/* Worker: the next free item (with an image slot in pixels when `image`), or NULL: full. Nothing is
 * visible until _put. */
ff_new_item *ff_new_data_begin(ff_new_data *list, int image);
/* 1 when a _begin would find room. */
int ff_new_data_room(ff_new_data *list, int image);
void ff_new_data_put(ff_new_data *list, ff_new_item *item);

/* Main thread: the oldest item, or NULL; it stays valid until _release. */
ff_new_item *ff_new_data_first(ff_new_data *list);
void ff_new_data_release(ff_new_data *list);
void ff_new_data_get_counts(ff_new_data *list, ff_new_data_counts *counts);

#endif
