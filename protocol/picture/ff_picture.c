/* Pictures: the walk through corners, lines and blocks, which both halves share, and decoding. */
#include "ff_picture_local.h"

#include <string.h>

#define ROOT        3 /* kinds of roots begin there */
#define QUALITY_MAX 100

const uint8_t ff_picture_built = 1;

int32_t ff_picture_step_q4(unsigned quality)
{
    if (quality < 1 || quality > QUALITY_MAX) return 0;
    if (quality == QUALITY_MAX) return 8;
    return (int32_t)(quality >= 50 ? 16 * (100 - quality) : 800 + 64 * (50 - quality));
}

int ff_picture_begin(ff_picture *p, unsigned log2, unsigned quality, ff_picture_above above)
{
    int32_t step_q4 = ff_picture_step_q4(quality);
    FF_ASSERT(log2 >= FF_PICTURE_LOG2_MIN && log2 <= FF_PICTURE_LOG2_MAX && above.quadrant < 4);
    if (!step_q4) return FF_ERR_FORMAT;
    p->side = 1u << log2;
    p->root = above.rgb ? 0 : ROOT;
    p->step_q4[0] = p->step_q4[2] = step_q4;
    p->step_q4[1] = step_q4 * 5 / 4;
    p->parent = above.rgb;
    p->column = (above.quadrant & 1u) * (p->side - 1);
    p->row = (above.quadrant >> 1) * (p->side - 1);
    p->one = p->room->one;
    memcpy(p->one, p->by->one, sizeof p->room->one);
    return FF_OK;
}

/* ---- texels ---- */

/* Adds what is left to the i-th texel of a part. */
static void finish(const ff_picture *p, unsigned x, unsigned y, unsigned i, uint8_t expected[64][3],
                   int32_t left[3][64])
{
    ff_picture_add(expected[i], left[0][i], left[1][i], left[2][i],
                   p->rgb + ff_picture_at(p, x, y));
}

static int16_t coefficient(const ff_picture *p, unsigned plane, int32_t value)
{
    return ff_picture_coefficient(value, p->step_q4[plane]);
}

/* ---- corners ---- */

static void go_corner(ff_picture *p, ff_picture_part part)
{
    uint8_t expected[64][3];
    int32_t value[3][64] = { { 0 } };
    ff_picture_expect(p, part, expected);
#ifdef FF_ENCODER
    if (p->to) ff_picture_count_corner(p, part, expected, value);
#endif
    for (unsigned plane = 0; plane < 3; plane++) {
        unsigned kind = plane + p->root;
#ifdef FF_ENCODER
        if (p->eye) p->eye->corner(p->eye->context, kind, value[plane][0]);
#endif
        int32_t number = ff_picture_number(p, kind, p->by->corner[kind], value[plane][0]);
        value[plane][0] = ((coefficient(p, plane, number) >> FF_PICTURE_CORNER_FINER) + 8) >> 4;
    }
    finish(p, part.x, part.y, 0, expected, value);
}

/* ---- lines ---- */

/* Numbers of eight texels of a line: sizes of those before, by plane, are known. */
static void line_numbers(ff_picture *p, unsigned plane, int32_t value[8], uint8_t before[3][8])
{
    unsigned kind = plane + p->root;
    int32_t size[FF_PICTURE_BLOCK + 2] = { 0 };
    for (unsigned u = FF_PICTURE_BLOCK; u-- > 0;) {
        unsigned weights = FF_PICTURE_OF_LINE(kind, u);
        /* luma's are in the place of those before */
        const int32_t known[FF_PICTURE_KNOWN] = { 1, size[u + 1], size[u + 2], before[plane][u],
                                                  plane ? before[0][u] : 0 };
        ff_picture_see(p, weights, known, value[u]);
        value[u] = ff_picture_number(p, kind, ff_picture_scale(p, weights, known), value[u]);
        size[u] = value[u] < 0 ? -value[u] : value[u];
        if (size[u] > 255) size[u] = 255;
    }
    for (unsigned u = 0; u < FF_PICTURE_BLOCK; u++) before[plane][u] = (uint8_t)size[u];
}

static void go_eight(ff_picture *p, ff_picture_part part, uint8_t before[3][8])
{
    uint8_t expected[64][3];
    int32_t value[3][64] = { { 0 } };
    if (p->parent)
        ff_picture_expect(p, part, expected);
    else
        ff_picture_between(p, part, expected);
#ifdef FF_ENCODER
    if (p->to) ff_picture_count_line(p, part, expected, value);
#endif
    for (unsigned plane = 0; plane < 3; plane++) {
        int16_t whole[FF_PICTURE_BLOCK];
        line_numbers(p, plane, value[plane], before);
        for (unsigned u = 0; u < FF_PICTURE_BLOCK; u++)
            whole[u] = coefficient(p, plane, value[plane][u]);
        whole[0] = (int16_t)(whole[0] >> FF_PICTURE_MEAN_FINER);
        ff_picture_line(whole, value[plane]);
    }
    unsigned upright = part.height > 1, from = upright ? part.y : part.x;
    for (unsigned i = 0; i < FF_PICTURE_BLOCK; i++)
        if (from + i != 0 && from + i != p->side - 1) /* corners are there */
            finish(p, part.x + (upright ? 0 : i), part.y + (upright ? i : 0), i, expected, value);
}

static void go_lines(ff_picture *p)
{
    unsigned last = p->side - 1;
    for (unsigned line = 0; line < 4; line++) {
        uint8_t before[3][FF_PICTURE_BLOCK] = { { 0 } };
        for (unsigned at = 0; at < p->side; at += FF_PICTURE_BLOCK) {
            unsigned aside = line & 1u ? last : 0;
            ff_picture_part part = line < 2 ? (ff_picture_part){ at, aside, FF_PICTURE_BLOCK, 1 }
                                            : (ff_picture_part){ aside, at, 1, FF_PICTURE_BLOCK };
            go_eight(p, part, before);
        }
    }
}

/* ---- blocks ---- */

static void go_block(ff_picture *p, unsigned column, unsigned row)
{
    uint8_t expected[64][3];
    int32_t value[3][64] = { { 0 } };
    ff_picture_part part = { column * FF_PICTURE_BLOCK, row * FF_PICTURE_BLOCK, FF_PICTURE_BLOCK,
                             FF_PICTURE_BLOCK };
    ff_picture_sizes here, *before = &p->room->before, *below = &p->room->below[column];
    ff_picture_expect(p, part, expected);
#ifdef FF_ENCODER
    if (p->to) ff_picture_count_block(p, part, expected, value);
#endif
    for (unsigned plane = 0; plane < 3; plane++) {
        int16_t whole[64];
        if (!ff_picture_numbers(p, plane, column ? before : NULL, row ? below : NULL, value[plane],
                                &here))
            continue; /* nothing is left */
        for (unsigned z = 0; z < 64; z++) whole[z] = coefficient(p, plane, value[plane][z]);
        ff_picture_block(whole, value[plane]);
    }
    *before = *below = here;
    /* lines are there */
    unsigned last = p->side - 1, i = 0;
    for (unsigned y = part.y; y < part.y + FF_PICTURE_BLOCK; y++)
        for (unsigned x = part.x; x < part.x + FF_PICTURE_BLOCK; x++, i++)
            if (x != 0 && x != last && y != 0 && y != last) finish(p, x, y, i, expected, value);
}

void ff_picture_go(ff_picture *p)
{
    unsigned last = p->side - 1, blocks = p->side / FF_PICTURE_BLOCK;
    for (unsigned corner = 0; corner < 4; corner++)
        go_corner(p, (ff_picture_part){ (corner & 1u) * last, (corner >> 1) * last, 1, 1 });
    go_lines(p);
    for (unsigned row = 0; row < blocks; row++)
        for (unsigned column = 0; column < blocks; column++) go_block(p, column, row);
}

int ff_picture_decode(const uint8_t *bytes, size_t count, unsigned log2, ff_picture_above above,
                      ff_picture_room *room, uint8_t *rgb)
{
    ff_picture p = { .by = &ff_picture_learned, .room = room, .rgb = rgb };
    if (count == 0) return FF_ERR_TRUNCATED;
    int rc = ff_picture_begin(&p, log2, bytes[0], above);
    if (rc != FF_OK) return rc;
    ff_range_read(&p.range, bytes + 1, count - 1);
    ff_picture_go(&p);
    /* a stream has no byte that says nothing */
    return ff_range_is_read(&p.range) && (count == 1 || bytes[count - 1]) ? FF_OK : FF_ERR_FORMAT;
}

int ff_picture_decode_row(const uint8_t *bytes, size_t count, unsigned log2, unsigned levels,
                          uint32_t code, ff_picture_room *room, uint8_t *rgb, uint8_t *spare)
{
    uint8_t *to = levels & 1u ? spare : rgb, *from = NULL;
    for (unsigned level = 0; level <= levels; level++) {
        size_t size = count;
        if (level < levels) {
            if (count < 2) return FF_ERR_TRUNCATED;
            size = (size_t)bytes[0] << 8 | bytes[1];
            bytes += 2;
            count -= 2;
            if (size > count) return FF_ERR_TRUNCATED;
        }
        ff_picture_above above = { from, from ? code >> 2 * (levels - level) & 3u : 0 };
        int rc = ff_picture_decode(bytes, size, log2, above, room, to);
        if (rc != FF_OK) return rc;
        bytes += size;
        count -= size;
        from = to;
        to = from == rgb ? spare : rgb;
    }
    return FF_OK;
}
