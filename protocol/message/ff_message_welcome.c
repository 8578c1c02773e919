/* The grounds that a WELCOME tells of, and what it says is not to be had. */
#include "ff_message_local.h"

#include "../ff_assert.h"

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

/* Each ground says how many levels are left out above it, or none does; it has room for them. */
static int entry_ok(const ff_welcome *welcome, unsigned count)
{
    const uint8_t *value;
    int told = ff_list_find(welcome->more, FF_WELCOME_ENTRY, &value);
    if (told < 0) return 1;
    for (unsigned i = 0; i < count; i++) {
        ff_terrain_info info;
        uint32_t whole;
        ff_welcome_ground(welcome, i, &info, &whole);
        if (info.entered > FF_KEY_LEVEL_MAX + info.node_log2 - info.tile_log2) return 0;
    }
    return (unsigned)told == count;
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
    return entry_ok(welcome, count) ? (int)count : FF_ERR_RANGE;
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
    if (!entries(welcome->more, FF_WELCOME_WHOLE, 4, &value)) return;
    ff_reader in = { value + 4 * number, value + 4 * number + 4, FF_OK };
    *whole = (uint32_t)ff_read_bytes(&in, 4);
}

uint32_t ff_welcome_lacks(const ff_welcome *welcome)
{
    const uint8_t *value;
    if (ff_list_find(welcome->more, FF_WELCOME_LACKS, &value) != 4) return 0;
    ff_reader in = { value, value + 4, FF_OK };
    return (uint32_t)ff_read_bytes(&in, 4);
}
