#include "ff_held_pictures.h"

#include "../../protocol/ff_assert.h"
#include "../../protocol/shape/ff_shape.h"

#include <string.h>

static size_t picture_bytes(unsigned log2) { return (size_t)3 << 2 * log2; }

size_t ff_held_pictures_bytes(unsigned log2, unsigned decoded, size_t coded)
{
    return sizeof(ff_picture_room) + decoded * picture_bytes(log2) + coded;
}

void ff_held_pictures_init(ff_held_pictures *pictures, unsigned log2, unsigned decoded,
                           size_t coded, void *memory)
{
    FF_ASSERT(decoded >= FF_DECODED_MIN && decoded <= FF_DECODED_MAX && coded <= UINT32_MAX);
    memset(pictures, 0, sizeof *pictures);
    pictures->room = memory;
    pictures->rgb = (uint8_t *)memory + sizeof(ff_picture_room);
    pictures->coded = pictures->rgb + decoded * picture_bytes(log2);
    pictures->coded_size = (uint32_t)coded;
    pictures->decoded_count = decoded;
    for (unsigned i = 0; i < decoded; i++) pictures->key[i] = FF_KEY_NONE;
}

ff_coded ff_held_pictures_add(ff_held_pictures *pictures, const uint8_t *bytes, uint32_t count)
{
    ff_coded coded = { pictures->coded_used, count };
    FF_ASSERT(count <= pictures->coded_size - pictures->coded_used);
    memcpy(pictures->coded + coded.at, bytes, count);
    pictures->coded_used += count;
    return coded;
}

void ff_held_pictures_cut(ff_held_pictures *pictures, ff_key key, ff_coded coded)
{
    uint32_t end = coded.at + coded.bytes;
    FF_ASSERT(end <= pictures->coded_used);
    memmove(pictures->coded + coded.at, pictures->coded + end, pictures->coded_used - end);
    pictures->coded_used -= coded.bytes;
    for (unsigned i = 0; i < pictures->decoded_count; i++)
        if (pictures->key[i] == key) pictures->key[i] = FF_KEY_NONE;
}

void ff_held_pictures_forget(ff_held_pictures *pictures)
{
    for (unsigned i = 0; i < pictures->decoded_count; i++) pictures->key[i] = FF_KEY_NONE;
}

/* ---- decoding ---- */

static uint8_t *place_at(const ff_held_pictures *pictures, const ff_terrain_info *info, unsigned i)
{
    FF_ASSERT(i < pictures->decoded_count);
    return pictures->rgb + i * picture_bytes(info->texture_log2);
}

static int find_place(const ff_held_pictures *pictures, ff_key key)
{
    FF_ASSERT(pictures->decoded_count <= FF_DECODED_MAX);
    for (unsigned i = 0; i < pictures->decoded_count; i++)
        if (pictures->key[i] == key) return (int)i;
    return -1;
}

/* A free place, or the one used least lately, but not `keep`. It is free now. */
static unsigned take_place(ff_held_pictures *pictures, int keep)
{
    unsigned best = keep == 0;
    for (unsigned i = 0; i < pictures->decoded_count; i++) {
        if ((int)i == keep) continue;
        if (pictures->key[best] == FF_KEY_NONE) break;
        if (pictures->key[i] == FF_KEY_NONE || pictures->used[i] < pictures->used[best]) best = i;
    }
    FF_ASSERT((int)best != keep && best < pictures->decoded_count);
    pictures->key[best] = FF_KEY_NONE;
    return best;
}

/* The code, in the whole terrain, of a root of an entered one. */
static uint32_t code_above(const ff_terrain_info *info, ff_key root)
{
    FF_ASSERT(ff_key_level(root) == 0);
    ff_sheet at = ff_shape_sheet(info, ff_key_tile(root));
    uint32_t within = (1u << info->entered) - 1u;
    return ff_morton_encode(at.x & within, at.y & within);
}

/* Decodes one whose parent's is in a place (below 0: it is a root) to another: which, or an error.
 */
static int decode(ff_held_pictures *pictures, const ff_terrain_info *info, ff_key key,
                  ff_coded coded, int parent)
{
    const uint8_t *bytes = pictures->coded + coded.at;
    unsigned to = take_place(pictures, parent), log2 = info->texture_log2;
    uint8_t *rgb = place_at(pictures, info, to);
    int rc;
    FF_ASSERT(coded.bytes <= pictures->coded_used &&
              coded.at <= pictures->coded_used - coded.bytes);
    if (parent < 0 && info->entered) {
        unsigned spare = take_place(pictures, (int)to);
        rc = ff_picture_decode_row(bytes, coded.bytes, log2, info->entered, code_above(info, key),
                                   pictures->room, rgb, place_at(pictures, info, spare));
    } else {
        ff_picture_above above = { 0 };
        if (parent >= 0)
            above = (ff_picture_above){ place_at(pictures, info, (unsigned)parent),
                                        ff_key_quadrant(key) };
        rc = ff_picture_decode(bytes, coded.bytes, log2, above, pictures->room, rgb);
    }
    pictures->decodes++;
    if (rc != FF_OK) return rc;
    pictures->key[to] = key;
    pictures->used[to] = ++pictures->stamp;
    return (int)to;
}

static ff_key above_by(ff_key key, uint32_t levels)
{
    FF_ASSERT(levels <= ff_key_level(key));
    while (levels-- > 0) key = ff_key_parent(key);
    return key;
}

const uint8_t *ff_held_pictures_get(ff_held_pictures *pictures, const ff_terrain_info *info,
                                    ff_key key, ff_find_coded *find, const void *context,
                                    int *error)
{
    uint32_t up = 0, level = ff_key_level(key);
    int place = find_place(pictures, key);
    while (place < 0 && up < level) place = find_place(pictures, above_by(key, ++up));
    if (place < 0) up++; /* the root, too, is to be decoded */
    FF_ASSERT(up <= level + 1);
    while (up-- > 0) {
        ff_key next = above_by(key, up);
        ff_coded coded = find(context, next);
        place = coded.bytes ? decode(pictures, info, next, coded, place) : FF_ERR_NOT_FOUND;
        *error = place < 0 ? place : FF_OK;
        if (place < 0) return NULL;
    }
    pictures->used[place] = ++pictures->stamp;
    return place_at(pictures, info, (unsigned)place);
}
