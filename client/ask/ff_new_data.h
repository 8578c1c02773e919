/* The new-data list: decoded answers on their way from the network worker to the main thread, first
 * in first out. One producer (worker), one consumer (main thread). A full list stops the worker
 * from receiving: nothing is thrown away. Items and images live in the client's block; an image
 * slot is taken only by items that carry pixels. */
#ifndef FF_NEW_DATA_H
#define FF_NEW_DATA_H

#include "../../protocol/ff_image.h"
#include "ff_request.h"

/* Of the fins in an image slot, before the paint. */
#define FF_NEW_FINS_BYTES (FF_FAR_VERTICES_MAX * sizeof(ff_fin_vertex))

/* One answer, or the news that none will come. */
typedef struct ff_new_item {
    ff_key key; /* of the request, as are id and kind */
    uint16_t id;
    uint8_t source;   /* whose answer it is: key and id are of its pack and queue */
    uint8_t kind;     /* enum ff_kind */
    uint8_t last;     /* ends its request: always, but for kinds with several answers; a part of a
                       * view has key and kind of its own */
    uint8_t layer;    /* of images: of the request */
    uint8_t refused;  /* no answer came: `error` says why, and nothing below counts */
    int32_t error;    /* FF_OK, or why there is nothing to take in */
    uint32_t bytes;   /* of the answer, for the counters */
    uint16_t *pixels; /* in an image slot; NULL: no image */
    uint16_t width, height;
    int32_t *room; /* words of the item's own, as many as a refinement has residuals */
    union {
        /* ROOT, REFINEMENT; value lies in `room` */
        ff_residuals residuals;
        /* VIEW, its end: bit i: what it names at i has not come */
        uint16_t missing;
        /* TEXTURE. pixels: RGB565, width x width, row 0 south, unless it is open all over; or, of
         * a picture, so many bytes as they came: what it is a difference to is the main thread's */
        struct {
            ff_image_marks marks;
            uint32_t coded_bytes; /* 0: texels */
        } texture;
        /* FACE. pixels: RGBA5551 of width x height (a power of two), row 0 lowest, texels without
         * ground transparent; none when the face is empty */
        struct {
            uint8_t face, empty; /* enum ff_face_name */
            uint16_t top_row, row_count;
        } face;
        /* FAR. pixels: `fins` vertices (ff_fin_vertex) in room for FF_FAR_VERTICES_MAX, then the
         * paint: RGBA5551 of width x height (powers of two; 0: none), row 0 the highest, texels
         * without paint transparent, the outermost always; `middle` and `top`: of ff_set_sector */
        struct {
            uint8_t sector, empty;
            uint16_t fins;
            int16_t middle, top;
        } far;
    } u;
} ff_new_item;

typedef struct ff_new_data {
    sys_mutex mutex; /* guards head, count, image_count */
    ff_new_item *item;
    int32_t *rooms;  /* item_slots of room_words each */
    uint8_t *images; /* image_slots of image_bytes each */
    size_t room_words, image_bytes;
    uint16_t item_slots, image_slots;
    uint16_t head, count, high;
    uint16_t image_head, image_count, image_high;
} ff_new_data;

/* In use now, and the most at once. */
typedef struct ff_new_data_counts {
    uint16_t items, items_high, images, images_high;
} ff_new_data_counts;

/* Bytes of items with room for `values` residuals each. */
size_t ff_new_data_item_bytes(unsigned item_slots, unsigned values);
void ff_new_data_init(ff_new_data *list, unsigned item_slots, unsigned values, void *items,
                      unsigned image_slots, size_t image_bytes, void *images);

/* Worker: the next free item, or NULL: full. Nothing is visible until _put; an item that is not put
 * was never begun. */
ff_new_item *ff_new_data_begin(ff_new_data *list);
/* Gives the item begun its image slot. 1, or 0: none is free. */
int ff_new_data_image(ff_new_data *list, ff_new_item *item);
/* 1 when there is room for an item, and with `image` for an image too. */
int ff_new_data_room(ff_new_data *list, int image);
void ff_new_data_put(ff_new_data *list, ff_new_item *item);

/* Main thread: the oldest item, or NULL; it stays valid until _release. */
ff_new_item *ff_new_data_first(ff_new_data *list);
void ff_new_data_release(ff_new_data *list);
void ff_new_data_get_counts(ff_new_data *list, ff_new_data_counts *counts);

#endif
