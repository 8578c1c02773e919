#include "ff_new_data.h"
#include "../../protocol/ff_assert.h"

#include <string.h>

FF_STATIC_ASSERT(sizeof(ff_new_item) % sizeof(int32_t) == 0); /* rooms lie right behind items */

size_t ff_new_data_item_bytes(unsigned item_slots, unsigned values)
{
    return item_slots * (sizeof(ff_new_item) + values * sizeof(int32_t));
}

void ff_new_data_init(ff_new_data *list, unsigned item_slots, unsigned values, void *items,
                      unsigned image_slots, size_t image_bytes, void *images)
{
    FF_ASSERT(item_slots > 0 && item_slots <= UINT16_MAX && image_slots <= item_slots);
    FF_ASSERT(image_bytes % sizeof(uint16_t) == 0);
    list->item = items;
    list->item_slots = (uint16_t)item_slots;
    list->images = images;
    list->image_slots = (uint16_t)image_slots;
    list->image_bytes = image_bytes;
    list->rooms = (int32_t *)(void *)(list->item + item_slots);
    list->room_words = values;
    sys_mutex_lock(&list->mutex);
    list->head = list->count = list->image_head = list->image_count = 0;
    list->high = list->image_high = 0;
    sys_mutex_unlock(&list->mutex);
}

int ff_new_data_room(ff_new_data *list, int image)
{
    sys_mutex_lock(&list->mutex);
    int room = list->count < list->item_slots && (!image || list->image_count < list->image_slots);
    sys_mutex_unlock(&list->mutex);
    return room;
}

ff_new_item *ff_new_data_begin(ff_new_data *list)
{
    sys_mutex_lock(&list->mutex);
    FF_ASSERT(list->count <= list->item_slots && list->head < list->item_slots);
    int room = list->count < list->item_slots; /* the other side only ever makes more */
    unsigned place = (list->head + list->count) % list->item_slots;
    sys_mutex_unlock(&list->mutex);
    if (!room) return NULL;
    ff_new_item *item = &list->item[place];
    memset(item, 0, sizeof *item);
    item->room = list->rooms + place * list->room_words;
    return item;
}

int ff_new_data_image(ff_new_data *list, ff_new_item *item)
{
    FF_ASSERT(!item->pixels); /* an item takes one slot */
    sys_mutex_lock(&list->mutex);
    FF_ASSERT(list->image_count <= list->image_slots);
    int room = list->image_count < list->image_slots;
    unsigned place = room ? (list->image_head + list->image_count) % list->image_slots : 0;
    sys_mutex_unlock(&list->mutex);
    if (room) item->pixels = (uint16_t *)(void *)(list->images + place * list->image_bytes);
    return room;
}

void ff_new_data_put(ff_new_data *list, ff_new_item *item)
{
    sys_mutex_lock(&list->mutex);
    FF_ASSERT(list->count < list->item_slots);
    FF_ASSERT(item == &list->item[(list->head + list->count) % list->item_slots]);
    list->count++;
    list->image_count = (uint16_t)(list->image_count + (item->pixels != NULL));
    FF_ASSERT(list->image_count <= list->image_slots);
    if (list->count > list->high) list->high = list->count;
    if (list->image_count > list->image_high) list->image_high = list->image_count;
    sys_mutex_unlock(&list->mutex);
}

ff_new_item *ff_new_data_first(ff_new_data *list)
{
    sys_mutex_lock(&list->mutex);
    ff_new_item *item = list->count ? &list->item[list->head] : NULL;
    sys_mutex_unlock(&list->mutex);
    return item;
}

void ff_new_data_release(ff_new_data *list)
{
    sys_mutex_lock(&list->mutex);
    FF_ASSERT(list->count > 0);
    if (list->item[list->head].pixels) {
        FF_ASSERT(list->image_count > 0);
        /* images come and go in the order of their items */
        FF_ASSERT((uint8_t *)list->item[list->head].pixels ==
                  list->images + list->image_head * list->image_bytes);
        list->image_head = (uint16_t)((list->image_head + 1) % list->image_slots);
        list->image_count--;
    }
    list->head = (uint16_t)((list->head + 1) % list->item_slots);
    list->count--;
    sys_mutex_unlock(&list->mutex);
}

void ff_new_data_get_counts(ff_new_data *list, ff_new_data_counts *counts)
{
    sys_mutex_lock(&list->mutex);
    FF_ASSERT(list->image_count <= list->count);
    *counts = (ff_new_data_counts){ list->count, list->high, list->image_count, list->image_high };
    sys_mutex_unlock(&list->mutex);
}
