#include "slow_picture.h"

#include "../../protocol/picture/ff_paint_local.h"

#include <stdlib.h>
#include <string.h>

#define SIDE_MAX 256

typedef struct stream {
    const uint8_t *bytes;
    long count, taken;
    uint64_t width, code;
} stream;

/* A block whose numbers are known; row -1: none is. */
typedef struct place {
    int row, column;
} place;

typedef struct picture {
    stream in;
    const ff_picture_tables *by;
    int side, is_root, quadrant;
    const uint8_t *parent;
    int64_t step[3], paint[3][4], one[FF_PICTURE_CONTEXTS];
    int rgb[SIDE_MAX][SIDE_MAX][3]; /* [y][x] */
    int numbers[SIDE_MAX / 8][SIDE_MAX / 8][3][8][8], counts[SIDE_MAX / 8][SIDE_MAX / 8][3];
} picture;

static const int quarter[8][4] = { { 64, 64, 64, 64 },   { 89, 75, 50, 18 },
                                   { 83, 36, -36, -83 }, { 75, -18, -89, -50 },
                                   { 64, -64, -64, 64 }, { 50, -89, 18, 75 },
                                   { 36, -83, 83, -36 }, { 18, -50, 75, -89 } };

static int m(int u, int x) { return x < 4 ? quarter[u][x] : u % 2 ? -m(u, 7 - x) : m(u, 7 - x); }

static int64_t within(int64_t least, int64_t value, int64_t most)
{
    return value < least ? least : value > most ? most : value;
}

static int64_t floored(int64_t value, int64_t divisor)
{
    int64_t whole = value / divisor;

    return whole * divisor > value ? whole - 1 : whole;
}

/* ---- decisions ---- */

static uint64_t next_byte(stream *in) { return in->taken < in->count ? in->bytes[in->taken++] : 0; }

static int chance(stream *in, int64_t probability)
{
    uint64_t part = in->width / 65536 * (uint64_t)probability;
    int is_one = in->code < part;

    if (is_one) in->width = part;
    if (!is_one) in->width -= part;
    if (!is_one) in->code -= part;
    while (in->width < 1u << 24) {
        in->width *= 256;
        in->code = (in->code * 256 + next_byte(in)) % (UINT64_C(1) << 32);
    }
    return is_one;
}

static int even(picture *p) { return chance(&p->in, 32768); }

static int decide(picture *p, int at)
{
    int is_one = chance(&p->in, p->one[at]);

    p->one[at] += is_one ? (65536 - p->one[at]) / 32 : -(p->one[at] / 32);
    return is_one;
}

/* ---- numbers ---- */

static int64_t sum_of(picture *p, int row, const int64_t known[5])
{
    int64_t sum = 0;

    for (int i = 0; i < 5; i++) sum += p->by->weight[row][i] * known[i];
    return sum;
}

static int how_many(const int *list, int count, int64_t sum)
{
    int many = 0;

    for (int i = 0; i < count; i++) many += list[i] <= sum;
    return many;
}

static int scale(picture *p, int row, const int64_t known[5])
{
    static const int from[] = { 11,  15,  20,  27,  35,  46,  59,   76,   97,   123,  156, 198,
                                251, 318, 401, 507, 640, 808, 1019, 1285, 1621, 2043, 2575 };

    return how_many(from, 23, sum_of(p, row, known));
}

static int64_t size_after_zero(picture *p, int k, int s)
{
    int64_t size = 1, rest = 1;
    int bits = 0;

    while (size <= 14 && decide(p, 144 + 336 * (k % 3 > 0) + 24 * ((int)size - 1) + s)) size++;
    if (size <= 14) return size;
    while (bits < 15 && even(p)) bits++;
    for (; bits > 0; bits--) rest = 2 * rest + even(p);
    return 14 + rest;
}

static int64_t not_zero(picture *p, int k, int s)
{
    int64_t size = size_after_zero(p, k, s);

    return even(p) ? -size : size;
}

static int64_t number(picture *p, int k, int s)
{
    return decide(p, 24 * k + s) ? not_zero(p, k, s) : 0;
}

static int count(picture *p, int k, int s)
{
    int class = 0, value = 1, first = 0;

    while (class < 7 && decide(p, 816 + 112 * k + 7 * s + class)) class ++;
    if (class < 3) return class;
    for (int i = 0; i < class - 2; i++) {
        int at = 1488 + 24 * k + 3 * class, bit;
        if (i == 0)
            bit = first = decide(p, at);
        else if (i == 1)
            bit = decide(p, at + 1 + first);
        else
            bit = even(p);
        value = 2 * value + bit;
    }
    return value + 1;
}

static int64_t coefficient(int64_t step, int64_t value)
{
    return within(-32767, value * step, 32767);
}

static int64_t size_of(int64_t value) { return within(0, llabs(value), 255); }

/* ---- texels ---- */

static void put(picture *p, int x, int y, const int expected[3], const int64_t left[3])
{
    p->rgb[y][x][0] = (int)within(0, expected[0] + left[0] + left[1] - left[2], 255);
    p->rgb[y][x][1] = (int)within(0, expected[1] + left[0] + left[2], 255);
    p->rgb[y][x][2] = (int)within(0, expected[2] + left[0] - left[1] - left[2], 255);
}

/* The weight, along an axis, of the parent's texel i at a place. */
static int weight(int at_place, int side, int i)
{
    int at = at_place / 2, off = i - at;

    if (at_place % 2 == 0 && (at_place == 0 || at_place == 2 * side - 2)) return off == 0 ? 16 : 0;
    if (at_place % 2 == 0) return off == 0 ? 14 : abs(off) == 1 ? 1 : 0;
    if (at == 0 || at == side - 2) return off == 0 || off == 1 ? 8 : 0;
    return off == 0 || off == 1 ? 9 : off == -1 || off == 2 ? -1 : 0;
}

static void of_parent(picture *p, int x, int y, int rgb[3])
{
    int place_x = x + (p->side - 1) * (p->quadrant % 2),
        place_y = y + (p->side - 1) * (p->quadrant / 2);
    int64_t sum[3] = { 0, 0, 0 };

    for (int j = place_y / 2 - 1; j <= place_y / 2 + 2; j++)
        for (int i = place_x / 2 - 1; i <= place_x / 2 + 2; i++) {
            int both = weight(place_x, p->side, i) * weight(place_y, p->side, j);
            if (!both) continue;
            for (int c = 0; c < 3; c++)
                sum[c] += both * p->parent[((p->side - 1 - j) * p->side + i) * 3 + c];
        }
    for (int c = 0; c < 3; c++) rgb[c] = (int)within(0, floored(sum[c] + 128, 256), 255);
}

static void of_block(picture *p, int x, int y, int rgb[3])
{
    int column = x ? x - 1 : 0, row = y ? y - 1 : 0, sum[3] = { 0, 0, 0 };

    for (int i = 0; i < 8; i++)
        for (int c = 0; c < 3; c++) sum[c] += p->rgb[y + i][column][c] + p->rgb[row][x + i][c];
    for (int c = 0; c < 3; c++) rgb[c] = (sum[c] + 8) / 16;
}

/* ---- corners and lines ---- */

static void corner(picture *p, int x, int y)
{
    int expected[3] = { 128, 128, 128 };
    int64_t left[3];

    if (!p->is_root) of_parent(p, x, y, expected);
    for (int plane = 0; plane < 3; plane++) {
        int k = plane + 3 * p->is_root;
        int64_t c = coefficient(p->step[plane], number(p, k, p->by->corner[k]));
        left[plane] = floored(floored(c, 4) + 8, 16);
    }
    put(p, x, y, expected, left);
}

static void of_line(picture *p, int x, int y, int is_upright, int rgb[3])
{
    int last = p->side - 1, i = is_upright ? y : x;

    if (!p->is_root) {
        of_parent(p, x, y, rgb);
        return;
    }
    const int *a = is_upright ? p->rgb[0][x] : p->rgb[y][0],
              *b = is_upright ? p->rgb[last][x] : p->rgb[y][last];
    for (int c = 0; c < 3; c++) rgb[c] = (a[c] * (last - i) + b[c] * i + last / 2) / last;
}

static void eight_numbers(picture *p, int plane, int64_t v[3][10], int64_t before[3][8])
{
    int k = plane + 3 * p->is_root;

    for (int u = 7; u >= 0; u--) {
        int64_t known[5] = { 1, size_of(v[plane][u + 1]), size_of(v[plane][u + 2]),
                             size_of(before[plane][u]), plane ? size_of(v[0][u]) : 0 };
        v[plane][u] = number(p, k, scale(p, 90 + 8 * k + u, known));
    }
}

static void line(picture *p, int is_upright, int aside)
{
    int64_t before[3][8] = { { 0 } };

    for (int from = 0; from < p->side; from += 8) {
        int64_t v[3][10] = { { 0 } };
        for (int plane = 0; plane < 3; plane++) eight_numbers(p, plane, v, before);
        for (int i = 0; i < 8; i++) {
            int x = is_upright ? aside : from + i, y = is_upright ? from + i : aside, expected[3];
            int64_t left[3] = { 1024, 1024, 1024 };
            for (int plane = 0; plane < 3; plane++) {
                for (int u = 0; u < 8; u++) {
                    int64_t c = coefficient(p->step[plane], v[plane][u]);
                    if (u == 0) c = floored(c, 2);
                    left[plane] += m(u, i) * floored(181 * c + 128, 256);
                }
                left[plane] = floored(left[plane], 2048);
            }
            if (from + i == 0 || from + i == p->side - 1) continue;
            of_line(p, x, y, is_upright, expected);
            put(p, x, y, expected, left);
        }
        for (int plane = 0; plane < 3; plane++)
            for (int u = 0; u < 8; u++) before[plane][u] = v[plane][u];
    }
}

/* ---- blocks ---- */

static int count_at(picture *p, place at, int plane)
{
    return at.row < 0 ? 8 : p->counts[at.row][at.column][plane];
}

static int block_count(picture *p, place here, place west, place south, int plane)
{
    static const int from[] = { 123,  177,  251,  358,  507,  720,   1019, 1444,
                                2043, 2892, 4091, 5788, 8187, 11581, 16379 };
    int k = plane + 3 * p->is_root;

    if (west.row < 0) west = south;
    if (south.row < 0) south = west;
    const int64_t known[5] = { 1, count_at(p, west, plane), count_at(p, south, plane),
                               plane ? count_at(p, here, 0) : 0,
                               plane == 2 ? count_at(p, here, 1) : 0 };
    return count(p, k, how_many(from, 15, sum_of(p, 138 + k, known)));
}

static int64_t size_at(int v[8][8], int row, int column)
{
    return row > 7 || column > 7 ? 0 : size_of(v[row][column]);
}

/* The zigzag, walked: up the diagonals and down. */
static void order(int places[64])
{
    int at = 0;

    for (int d = 0; d < 15; d++)
        for (int i = 0; i <= d; i++) {
            int v = d % 2 ? i : d - i, u = d - v;
            if (u < 8 && v < 8) places[at++] = 8 * v + u;
        }
}

static int64_t size_of_block(picture *p, place at, int plane, int row, int column)
{
    return at.row < 0 ? 0 : size_of(p->numbers[at.row][at.column][plane][row][column]);
}

static void block_numbers(picture *p, place here, place west, place south, int plane)
{
    int places[64], k = plane + 3 * p->is_root, n = block_count(p, here, west, south, plane);
    int(*v)[8] = p->numbers[here.row][here.column][plane];

    order(places);
    memset(v, 0, 64 * sizeof **v);
    p->counts[here.row][here.column][plane] = n;
    for (int i = n - 1; i >= 0; i--) {
        int r = places[i] / 8, u = places[i] % 8;
        const int64_t known[5] = { 1, size_at(v, r, u + 1) + size_at(v, r + 1, u),
                                   size_at(v, r + 1, u + 1) + size_at(v, r, u + 2) +
                                       size_at(v, r + 2, u),
                                   size_of_block(p, west, plane, r, u),
                                   size_of_block(p, south, plane, r, u) };
        int s = scale(p, 15 * k + r + u, known);
        v[r][u] = (int)(i == n - 1 ? not_zero(p, k, s) : number(p, k, s));
    }
}

static int64_t left_at(picture *p, int column, int row, int plane, int x, int y)
{
    int64_t sum = 2048;

    for (int v = 0; v < 8; v++) {
        int64_t t = 64;
        for (int u = 0; u < 8; u++)
            t += m(u, x) * coefficient(p->paint[plane][u + v < 3 ? u + v : 3],
                                       p->numbers[row][column][plane][v][u]);
        sum += m(v, y) * floored(t, 128);
    }
    return floored(sum, 4096);
}

static void block(picture *p, int column, int row)
{
    int flat[3] = { 0 };

    if (p->is_root) of_block(p, 8 * column, 8 * row, flat);
    place west = { column ? row : -1, column - 1 }, south = { row - 1, column };
    for (int plane = 0; plane < 3; plane++)
        block_numbers(p, (place){ row, column }, west, south, plane);
    for (int i = 0; i < 64; i++) {
        int x = 8 * column + i % 8, y = 8 * row + i / 8, last = p->side - 1, expected[3];
        int64_t left[3];
        if (x == 0 || y == 0 || x == last || y == last) continue;
        memcpy(expected, flat, sizeof flat);
        if (!p->is_root) of_parent(p, x, y, expected);
        for (int plane = 0; plane < 3; plane++)
            left[plane] = left_at(p, column, row, plane, i % 8, i / 8);
        put(p, x, y, expected, left);
    }
}

/* ---- all of it ---- */

static int begin(picture *p, const ff_picture_tables *by, const uint8_t *bytes, long bytes_count)
{
    int q = bytes_count > 0 ? bytes[0] : 0;

    if (q < 1 || q > 100) return -1;
    p->by = by;
    p->step[0] = p->step[2] = q == 100 ? 8 : q >= 50 ? 16 * (100 - q) : 800 + 64 * (50 - q);
    p->step[1] = p->step[0] * 5 / 4;
    for (int i = 0; i < 12; i++) p->paint[i / 4][i % 4] = p->step[i / 4];
    for (int i = 0; i < FF_PICTURE_CONTEXTS; i++) p->one[i] = by->one[i];
    p->in = (stream){ .bytes = bytes + 1, .count = bytes_count - 1, .width = UINT32_MAX };
    for (int i = 0; i < 4; i++) p->in.code = 256 * p->in.code + next_byte(&p->in);
    return 0;
}

int slow_picture(const uint8_t *bytes, long bytes_count, int side, const uint8_t *parent,
                 int quadrant, uint8_t *rgb)
{
    static picture made;
    picture *p = &made;
    int last = side - 1;

    *p = (picture){ .side = side, .parent = parent, .is_root = !parent, .quadrant = quadrant };
    if (begin(p, &ff_picture_learned, bytes, bytes_count)) return -1;
    for (int c = 0; c < 4; c++) corner(p, c % 2 * last, c / 2 * last);
    for (int l = 0; l < 4; l++) line(p, l / 2, l % 2 * last);
    for (int row = 0; row < side / 8; row++)
        for (int column = 0; column < side / 8; column++) block(p, column, row);
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++)
            for (int c = 0; c < 3; c++)
                rgb[((side - 1 - y) * side + x) * 3 + c] = (uint8_t)p->rgb[y][x][c];
    if (p->in.taken < p->in.count) return -1;
    return bytes_count > 1 && bytes[bytes_count - 1] == 0 ? -1 : 0;
}

/* ---- paint ---- */

/* Steps of Co, then of Cg: of the mean, of frequencies 1, 2, and beyond. */
static const int in_halves[8] = { 3, 5, 7, 10, 3, 4, 5, 8 };
static const int fades[8] = { 120, 85, 62, 46, 34, 25, 20, 15 };

/* Channel c of the i-th texel beside a block: of its left side from the top, of its top from the
 * left. */
static int beside(picture *p, place block, int of_left, int i, int c)
{
    return of_left ? p->rgb[8 * block.row + i][8 * block.column - 1][c]
                   : p->rgb[8 * block.row - 1][8 * block.column + i][c];
}

static int paint_expected(picture *p, place block, int has_left, int has_above, int x, int y, int c)
{
    int sum = 0, parts = 8 * (has_left + has_above);
    int64_t off = 128;

    for (int i = 0; i < 8; i++) {
        if (has_left) sum += beside(p, block, 1, i, c);
        if (has_above) sum += beside(p, block, 0, i, c);
    }
    int mean = (sum + parts / 2) / parts;
    if (has_left) off += fades[x] * (beside(p, block, 1, y, c) - mean);
    if (has_above) off += fades[y] * (beside(p, block, 0, x, c) - mean);
    return (int)within(0, mean + floored(off, 256), 255);
}

/* Of a block with nothing beside it: as if the right side of the block before were its left one. */
static int paint_alone(picture *p, place last, int x, int y, int c)
{
    int sum = 4, edge[8];

    for (int i = 0; i < 8; i++) {
        edge[i] = last.row < 0 ? 128 : p->rgb[8 * last.row + i][8 * last.column + 7][c];
        sum += edge[i];
    }
    return (int)within(0, sum / 8 + floored(fades[x] * (edge[y] - sum / 8) + 128, 256), 255);
}

/* `last`: the block before, wherever it is. */
static void paint_block(picture *p, place here, int has_left, int has_above, place last)
{
    place above = { here.row - 1, here.column }, left = last;
    if (!has_left && has_above) left = above;
    if (!has_above) above = last;
    for (int plane = 0; plane < 3; plane++) block_numbers(p, here, left, above, plane);
    for (int i = 0; i < 64; i++) {
        int expected[3], x = i % 8, y = i / 8;
        int64_t rest[3];
        for (int c = 0; c < 3; c++) {
            if (has_left || has_above)
                expected[c] = paint_expected(p, here, has_left, has_above, x, y, c);
            else
                expected[c] = paint_alone(p, last, x, y, c);
            rest[c] = left_at(p, here.column, here.row, c, x, y);
        }
        put(p, 8 * here.column + x, 8 * here.row + y, expected, rest);
    }
}

int slow_paint(const uint8_t *bytes, long bytes_count, int columns, int rows, uint8_t *there,
               uint8_t *rgb)
{
    static picture made;
    picture *p = &made;
    int64_t one[16];
    int count = 0;
    place last = { -1, 0 };

    *p = (picture){ .side = 8 };
    if (begin(p, &ff_paint_learned.numbers, bytes, bytes_count)) return -1;
    for (int i = 0; i < 8; i++) p->paint[1 + i / 4][i % 4] = in_halves[i] * p->step[0] / 2;
    for (int i = 0; i < 16; i++) one[i] = ff_paint_learned.there[i];
    for (int i = 0; i < rows * columns; i++) {
        int row = i / columns, column = i % columns, left = column && there[i - 1],
            above = row && there[i - columns], above_left = row && column && there[i - columns - 1],
            above_right = row && column + 1 < columns && there[i - columns + 1],
            around = left + 2 * above + 4 * above_left + 8 * above_right;
        there[i] = (uint8_t)chance(&p->in, one[around]);
        one[around] += there[i] ? (65536 - one[around]) / 32 : -(one[around] / 32);
        if (!there[i]) continue;
        paint_block(p, (place){ row, column }, left, above, last);
        last = (place){ row, column };
        count++;
    }
    for (int y = 0; y < 8 * rows; y++)
        for (int x = 0; x < 8 * columns; x++)
            for (int c = 0; c < 3; c++)
                rgb[(y * 8 * columns + x) * 3 + c] = (uint8_t)p->rgb[y][x][c];
    if (p->in.taken < p->in.count || count == 0) return -1;
    return bytes_count > 1 && bytes[bytes_count - 1] == 0 ? -1 : count;
}
