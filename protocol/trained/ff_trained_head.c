/* What a payload of codec trained tells of itself and of its nodes, ahead of all heights: the first
 * bits of its tail (SPEC.md, "Payload, codec 3"). Nearly all payloads of the finest level do with
 * one bit: their children are off by the largest error. */
#include "ff_trained.h"

enum codes { CODES_TOLD, CODES_BOUND, CODES_ZERO };

#define FIRST_ORDER 1 /* of numbers: how much the first child is better than the largest error */
#define FINE_ORDER  1 /* how far another is from the mean of those before, where the first is so */
#define ORDER       3 /* the same elsewhere */

/* The code of the largest error that heights may have. */
static uint8_t bound_of(const ff_terrain_info *info, int root)
{
    return ff_geometric_error_encode((uint32_t)ff_quantum(info, root) / 2);
}

/* ---- taking ---- */

static int take_codes(int32_t bound, ff_tail *tail, uint32_t errors, uint8_t *code)
{
    int32_t sum = 0;
    FF_ASSERT(errors == 1 || errors == 4);
    for (uint32_t i = 0; i < errors; i++) {
        int32_t value;
        if (i > 0)
            value = (sum + (int32_t)i / 2) / (int32_t)i +
                    ff_unzigzag(ff_tail_number(tail, code[0] <= bound ? FINE_ORDER : ORDER));
        else
            value = ff_tail_take(tail, 1) ? bound - (int32_t)ff_tail_number(tail, FIRST_ORDER)
                                          : (int32_t)ff_tail_take(tail, 8);
        if (value < 0 || value > FF_ERROR_CODE_MAX) return FF_ERR_RANGE;
        code[i] = (uint8_t)value;
        sum += value;
    }
    return FF_OK;
}

static uint8_t take_mark(ff_tail *tail)
{
    return ff_tail_take(tail, 1) ? (uint8_t)ff_tail_take(tail, 4) : 0;
}

/* A head that says all. */
static int take_whole(ff_tail *tail, uint32_t errors, enum codes *codes, ff_residuals *out)
{
    uint32_t form = ff_tail_take(tail, 2);
    if (ff_tail_take(tail, 1)) {
        out->stub = take_mark(tail);
        out->leaf = take_mark(tail);
        out->filled = take_mark(tail);
    }
    *codes = ff_tail_take(tail, 1) ? CODES_BOUND : ff_tail_take(tail, 1) ? CODES_ZERO : CODES_TOLD;
    if ((out->stub | out->leaf | out->filled) >> errors || out->stub & out->leaf)
        return FF_ERR_RANGE;
    if (form > 2 || (form == 1 && errors == 1)) return FF_ERR_FORMAT;
    out->apart = form == 2 ? FF_SIDES_WORDS : form == 1 ? FF_SIDES_NONE : FF_SIDES_BARE;
    return FF_OK;
}

static void take_sides(ff_tail *tail, ff_residuals *out)
{
    FF_ASSERT(out->apart == FF_SIDES_BARE);
    out->sides = (uint8_t)ff_tail_take(tail, FF_SIDE_COUNT);
    if (out->sides < FF_TRAINED_SIDES || ff_tail_take(tail, 1)) return;
    out->apart = FF_SIDES_MEASURED;
    out->sides = 0;
}

int ff_trained_take_head(const ff_terrain_info *info, int root, ff_tail *tail, ff_residuals *out)
{
    uint32_t errors = root ? 1 : 4;
    enum codes codes = CODES_BOUND;
    int rc = FF_OK;
    out->stub = out->leaf = out->filled = out->way = out->sides = 0;
    out->apart = FF_SIDES_BARE;
    if (!ff_tail_take(tail, 1)) {
        int plain = (int)ff_tail_take(tail, 1);
        int known = plain || ff_tail_take(tail, 1);
        out->way = plain ? 1 : (uint8_t)ff_tail_take(tail, 1);
        if (!plain) codes = CODES_TOLD;
        if (!known) rc = take_whole(tail, errors, &codes, out);
    }
    uint8_t bound = bound_of(info, root);
    for (uint32_t i = 0; i < 4; i++)
        out->child_error[i] = i < errors && codes == CODES_BOUND ? bound : 0;
    if (rc == FF_OK && codes == CODES_TOLD) rc = take_codes(bound, tail, errors, out->child_error);
    if (rc != FF_OK) return rc;
    if (root && out->apart == FF_SIDES_BARE) out->apart = FF_SIDES_NONE;
    if (out->apart == FF_SIDES_BARE) take_sides(tail, out);
    return ff_tail_is_short(tail) ? FF_ERR_TRUNCATED : FF_OK;
}

/* ---- putting ---- */

static void put_codes(int32_t bound, const uint8_t *code, uint32_t errors, ff_bits *to)
{
    int32_t sum = code[0];
    int fine = code[0] <= bound;
    FF_ASSERT(bound <= FF_ERROR_CODE_MAX && code[0] <= FF_ERROR_CODE_MAX);
    ff_bits_put(to, (unsigned)fine, 1);
    if (fine)
        ff_bits_number(to, (uint32_t)(bound - code[0]), FIRST_ORDER);
    else
        ff_bits_put(to, code[0], 8);
    for (uint32_t i = 1; i < errors; sum += code[i++])
        ff_bits_number(to, ff_zigzag(code[i] - (sum + (int32_t)i / 2) / (int32_t)i),
                       fine ? FINE_ORDER : ORDER);
}

static void put_mark(uint8_t mark, ff_bits *to)
{
    FF_ASSERT(mark < 16);
    ff_bits_put(to, mark > 0, 1);
    if (mark) ff_bits_put(to, mark, 4);
}

static void put_whole(const ff_residuals *res, enum codes codes, ff_bits *to)
{
    unsigned marks = res->stub | res->leaf | res->filled;
    ff_bits_put(to, res->way, 4); /* behind three times 0 */
    ff_bits_put(to, res->apart == FF_SIDES_WORDS ? 2 : res->apart == FF_SIDES_NONE, 2);
    ff_bits_put(to, marks > 0, 1);
    if (marks) {
        put_mark(res->stub, to);
        put_mark(res->leaf, to);
        put_mark(res->filled, to);
    }
    ff_bits_put(to, codes != CODES_TOLD, codes == CODES_BOUND ? 1 : 2);
}

static enum codes codes_of(const ff_residuals *res, uint32_t errors, uint8_t bound)
{
    int same = 1;
    for (uint32_t i = 1; i < errors; i++) same &= res->child_error[i] == res->child_error[0];
    return same && res->child_error[0] == bound ? CODES_BOUND
           : same && !res->child_error[0]       ? CODES_ZERO
                                                : CODES_TOLD;
}

void ff_trained_put_head(const ff_terrain_info *info, int root, const ff_residuals *res,
                         ff_bits *to)
{
    uint32_t errors = root ? 1 : 4;
    uint8_t bound = bound_of(info, root);
    ff_residuals head = *res;
    enum codes codes = codes_of(res, errors, bound);
    int streams = res->apart == FF_SIDES_BARE || res->apart == FF_SIDES_MEASURED;
    FF_ASSERT(res->way < FF_TRAINED_SETS && (!root || !streams));
    FF_ASSERT(!(res->stub & res->leaf) && (res->stub | res->leaf | res->filled) >> errors == 0);
    if (root && res->apart == FF_SIDES_NONE) head.apart = FF_SIDES_BARE; /* there are no others */
    if (head.apart == FF_SIDES_NONE || head.apart == FF_SIDES_WORDS ||
        res->stub | res->leaf | res->filled || codes == CODES_ZERO)
        put_whole(&head, codes, to);
    else if (codes == CODES_BOUND)
        ff_bits_put(to, 1, res->way ? 2 : 1);
    else
        ff_bits_put(to, 2u | res->way, 4);
    if (codes == CODES_TOLD) put_codes(bound, res->child_error, errors, to);
    if (!streams) return;
    ff_bits_put(to, res->apart == FF_SIDES_MEASURED ? FF_TRAINED_SIDES : res->sides, FF_SIDE_COUNT);
    if (res->apart == FF_SIDES_MEASURED || res->sides == FF_TRAINED_SIDES)
        ff_bits_put(to, res->apart != FF_SIDES_MEASURED, 1);
}
