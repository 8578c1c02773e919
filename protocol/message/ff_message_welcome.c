/* The grounds that a WELCOME tells of, and what it says is not to be had. */
#include "ff_message_local.h"

#include "../ff_assert.h"

#include <string.h>

void ff_message_write_terrain(ff_writer *out, const ff_terrain_info *info)
{
    uint8_t plain[FF_TERRAIN_BYTES], value[FF_TERRAIN_SET + FF_TERRAIN_BYTES] = { 0 };
    ff_writer terrain = { plain, plain + sizeof plain, FF_OK };
    uint32_t count = FF_TERRAIN_SET;
    ff_write_terrain(&terrain, info);
    FF_ASSERT(terrain.error == FF_OK && terrain.at == terrain.end);
    for (unsigned i = 0; i < FF_TERRAIN_BYTES; i++) {
        if (!plain[i]) continue;
        value[i / 8] |= (uint8_t)(1u << i % 8);
        value[count++] = plain[i];
    }
    ff_list_write(out, FF_WELCOME_TERRAIN, value, count);
}

int ff_message_read_terrain(const ff_list_entry *entry, ff_terrain_info *info)
{
    uint8_t plain[FF_TERRAIN_BYTES] = { 0 };
    ff_reader in = { entry->value, entry->value + entry->byte_count, FF_OK },
              terrain = { plain, plain + sizeof plain, FF_OK };
    const uint8_t *set = ff_read_span(&in, FF_TERRAIN_SET);
    for (unsigned i = 0; in.error == FF_OK && i < 8 * FF_TERRAIN_SET; i++) {
        if (!(set[i / 8] >> i % 8 & 1u)) continue;
        uint8_t byte = (uint8_t)ff_read_bytes(&in, 1);
        ff_message_require(&in.error, byte && i < FF_TERRAIN_BYTES);
        if (in.error == FF_OK) plain[i] = byte;
    }
    ff_message_require(&in.error, in.at == in.end);
    if (in.error != FF_OK) return in.error;
    ff_read_terrain(&terrain, info);
    return terrain.error;
}

/* How many values of `bytes` an entry has; 0: there is no such entry, or a part of one is left. */
static unsigned entries(ff_list list, unsigned type, unsigned bytes, const uint8_t **value)
{
    int count = ff_list_find(list, type, value);
    return count > 0 && (unsigned)count % bytes == 0 ? (unsigned)count / bytes : 0;
}

/* Where a row of terrains ends. */
typedef struct row {
    const ff_terrain_info *first;
    ff_terrain_info last;
} row;

/* The next terrain of the row, in its place behind those before. FF_OK or an error. */
static int read_next(const uint8_t *bytes, row *r, ff_terrain_info *info)
{
    ff_reader in = { bytes, bytes + FF_TERRAIN_BYTES, FF_OK };
    ff_read_terrain(&in, info);
    int rc = in.error == FF_OK ? ff_terrain_join(info, r->first, &r->last) : in.error;
    r->last = *info;
    return rc;
}

/* Each ground says how many levels are left out above it, or none does; it has room for them. The
 * same of levels with all images. */
static int levels_ok(const ff_welcome *welcome, unsigned count)
{
    const uint8_t *value;
    int entries = ff_list_find(welcome->more, FF_WELCOME_ENTRY, &value),
        images = ff_list_find(welcome->more, FF_WELCOME_IMAGES, &value);
    if ((entries >= 0 && (unsigned)entries != count) || (images >= 0 && (unsigned)images != count))
        return 0;
    for (unsigned i = 0; i < count; i++) {
        ff_terrain_info info;
        uint32_t whole;
        ff_welcome_ground(welcome, i, &info, &whole);
        if (info.entered > FF_KEY_LEVEL_MAX + info.node_log2 - info.tile_log2 ||
            info.images_whole > info.texture_levels)
            return 0;
    }
    return 1;
}

int ff_welcome_count(const ff_welcome *welcome)
{
    const uint8_t *value;
    row r = { &welcome->info, welcome->info };
    unsigned more = entries(welcome->more, FF_WELCOME_TERRAINS, FF_TERRAIN_BYTES, &value),
             count = 1 + more;
    if (!more && ff_list_find(welcome->more, FF_WELCOME_TERRAINS, &value) > 0) return FF_ERR_RANGE;
    for (unsigned i = 0; i < more; i++) {
        ff_terrain_info info;
        int rc = read_next(value + i * FF_TERRAIN_BYTES, &r, &info);
        if (rc != FF_OK) return rc;
    }
    if (ff_list_find(welcome->more, FF_WELCOME_WHOLE, &value) > 0 &&
        entries(welcome->more, FF_WELCOME_WHOLE, 4, &value) != count)
        return FF_ERR_RANGE;
    int layers = ff_list_find(welcome->more, FF_WELCOME_LAYERS, &value);
    if (layers > 0 && ff_layers_read(value, (uint32_t)layers, count, NULL) != FF_OK)
        return FF_ERR_RANGE;
    return levels_ok(welcome, count) ? (int)count : FF_ERR_RANGE;
}

void ff_welcome_ground(const ff_welcome *welcome, unsigned number, ff_terrain_info *info,
                       uint32_t *whole)
{
    const uint8_t *value;
    row r = { &welcome->info, welcome->info };
    *info = welcome->info;
    if (number) (void)entries(welcome->more, FF_WELCOME_TERRAINS, FF_TERRAIN_BYTES, &value);
    for (unsigned i = 0; i < number; i++) {
        int rc = read_next(value + i * FF_TERRAIN_BYTES, &r, info);
        FF_ASSERT(rc == FF_OK); /* they were counted */
        (void)rc;
    }
    *whole = info->checksum;
    if (number < entries(welcome->more, FF_WELCOME_ENTRY, 1, &value)) info->entered = value[number];
    if (number < entries(welcome->more, FF_WELCOME_IMAGES, 1, &value))
        info->images_whole = value[number];
    if (!entries(welcome->more, FF_WELCOME_WHOLE, 4, &value)) return;
    ff_reader in = { value + 4 * number, value + 4 * number + 4, FF_OK };
    *whole = (uint32_t)ff_read_bytes(&in, 4);
}

/* The levels of images of the grounds themselves are the first layer's; where they have none no
 * other layer has. */
static void first_levels(const ff_welcome *welcome, ff_layers *layers)
{
    int count = ff_welcome_count(welcome);
    for (int i = 0; i < count; i++) {
        ff_terrain_info info;
        uint32_t whole;
        ff_welcome_ground(welcome, (unsigned)i, &info, &whole);
        layers->levels[0][i] = info.texture_levels;
        for (unsigned layer = 1; !info.texture_levels && layer < layers->count; layer++)
            layers->levels[layer][i] = 0;
        if (info.texture_levels && !layers->count) layers->count = 1;
    }
}

void ff_welcome_layers(const ff_welcome *welcome, ff_layers *layers)
{
    const uint8_t *value;
    int bytes = ff_list_find(welcome->more, FF_WELCOME_LAYERS, &value);
    unsigned grounds = (unsigned)ff_welcome_count(welcome);
    if (bytes <= 0 || ff_layers_read(value, (uint32_t)bytes, grounds, layers) != FF_OK)
        memset(layers, 0, sizeof *layers);
    first_levels(welcome, layers);
}

uint32_t ff_welcome_lacks(const ff_welcome *welcome)
{
    const uint8_t *value;
    if (ff_list_find(welcome->more, FF_WELCOME_LACKS, &value) != 4) return 0;
    ff_reader in = { value, value + 4, FF_OK };
    return (uint32_t)ff_read_bytes(&in, 4);
}
