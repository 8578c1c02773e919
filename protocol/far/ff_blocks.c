/* Which blocks of a picture are there, as lengths of runs (SPEC.md, "Paint"). */
#include "ff_bits.h"
#include "ff_far.h"

#define ORDER_RUN 2

static int count_ok(uint32_t count)
{
    return count > 0 && count <= FF_FAR_BLOCKS_MAX * FF_FAR_BLOCKS_MAX;
}

static int found_ok(uint32_t found) { return found > 0 && found <= FF_FAR_THERE_MAX; }

/* The first run is of blocks that are not there, and may be empty; runs after it are not. */
int ff_blocks_encode(const uint8_t *there, uint32_t count, uint8_t *out, size_t capacity)
{
    ff_bits bits = { .out = out, .limit = 8 * capacity };
    uint32_t found = 0;
    uint8_t now = 0;
    if (!count_ok(count)) return FF_ERR_RANGE;
    for (uint32_t i = 0; i < count; now ^= 1u) {
        uint32_t run = 0, first = i == 0 && now == 0;
        while (i + run < count && there[i + run] == now) run++;
        if (!first && run == 0) return FF_ERR_RANGE; /* neither 0 nor 1 */
        ff_bits_put_number(&bits, first ? run : run - 1, ORDER_RUN);
        found += now ? run : 0;
        i += run;
    }
    return found_ok(found) ? ff_bits_written(&bits) : FF_ERR_RANGE;
}

int ff_blocks_decode(const uint8_t *bytes, size_t byte_count, uint8_t *there, uint32_t count)
{
    ff_bits bits = { .in = bytes, .limit = 8 * byte_count };
    uint32_t found = 0, i = 0;
    if (!count_ok(count)) return FF_ERR_RANGE;
    for (uint8_t now = 0; i < count; now ^= 1u) {
        uint32_t run = ff_bits_take_number(&bits, ORDER_RUN) + (i > 0 || now);
        if (bits.error != FF_OK) return bits.error;
        if (bits.at > bits.limit) return FF_ERR_TRUNCATED;
        if (run > count - i) return FF_ERR_RANGE;
        for (uint32_t end = i + run; i < end; i++) there[i] = now;
        found += now ? run : 0;
    }
    int rc = ff_bits_end(&bits);
    if (rc == FF_OK && !found_ok(found)) rc = FF_ERR_RANGE;
    return rc == FF_OK ? (int)found : rc;
}
