#include "slow_decoder.h"

#include "slow_trained.h"

#include <string.h>
#include <zlib.h>

#define SIDE_MAX 65

typedef struct field {
    long height[SIDE_MAX][SIDE_MAX]; /* [y][x] */
    int last;                        /* largest x and y */
    int ground_x, ground_y;          /* cells with ground */
    long maximum_error;
    const long *residual;
} field;

/* floor(sum / divisor + 1/2), then into 0..65535 */
static long rounded(long sum, long divisor)
{
    long twice = 2 * sum + divisor;

    if (twice < 0) return 0;
    return twice / (2 * divisor) > 65535 ? 65535 : twice / (2 * divisor);
}

/* Sample number t of the line through (x, y) in direction (dx, dy): t counts known samples from the
 * line's south or west end. */
static long on_line(const field *f, int x, int y, int dx, int dy, int gap, int t)
{
    return f->height[dy ? t * gap : y][dx ? t * gap : x];
}

static long line_prediction(const field *f, int x, int y, int dx, int dy, int gap)
{
    int before = (dx ? x : y) / gap, last = f->last / gap;
    long near_low = on_line(f, x, y, dx, dy, gap, before),
         near_high = on_line(f, x, y, dx, dy, gap, before + 1);

    if (last == 1) return rounded(near_low + near_high, 2);
    if (before == 0)
        return rounded(7 * near_low + 10 * near_high - on_line(f, x, y, dx, dy, gap, 2), 16);
    if (before == last - 1)
        return rounded(10 * near_low + 7 * near_high - on_line(f, x, y, dx, dy, gap, last - 2), 16);
    return rounded(9 * near_low + 9 * near_high - on_line(f, x, y, dx, dy, gap, before - 1) -
                       on_line(f, x, y, dx, dy, gap, before + 2),
                   16);
}

static long centre_prediction(const field *f, int x, int y, int half)
{
    long cross = 0, corners = 0;

    for (int j = -1; j <= 1; j++)
        for (int i = -1; i <= 1; i++) {
            if ((i == 0) != (j == 0))
                cross += f->height[y + j * half][x + i * half];
            else if (i != 0)
                corners += f->height[y + j * half][x + i * half];
        }
    return rounded(7 * cross - 3 * corners, 16);
}

static void add(field *f, int x, int y, long prediction)
{
    long height = prediction + *f->residual++ * (2 * f->maximum_error + 1);

    if (f->maximum_error == 0) height = ((height % 65536) + 65536) % 65536;
    f->height[y][x] = height < 0 ? 0 : height > 65535 ? 65535 : height;
}

/* Where the height of a point comes from that the payload does not tell: the first known one at or
 * beyond the ground's end, when it lies there. */
static int shown(int at, int gap, int ground)
{
    int end = 0;

    while (end < ground) end += gap;
    return (at % gap != 0 && at >= ground) || at > end ? end : at;
}

/* A point that a doubling makes: told, or repeated. */
static void make(field *f, int x, int y, int gap, long prediction)
{
    int from_x = shown(x, gap, f->ground_x), from_y = shown(y, gap, f->ground_y);

    if (from_x == x && from_y == y)
        add(f, x, y, prediction);
    else
        f->height[y][x] = f->height[from_y][from_x];
}

static void double_resolution(field *f, int gap)
{
    int half = gap / 2;

    for (int y = 0; y <= f->last; y += gap)
        for (int x = half; x <= f->last; x += gap)
            make(f, x, y, gap, line_prediction(f, x, y, 1, 0, gap));
    for (int x = 0; x <= f->last; x += gap)
        for (int y = half; y <= f->last; y += gap)
            make(f, x, y, gap, line_prediction(f, x, y, 0, 1, gap));
    for (int y = half; y <= f->last; y += gap)
        for (int x = half; x <= f->last; x += gap)
            make(f, x, y, gap, centre_prediction(f, x, y, half));
}

/* How many points a doubling tells. */
static int told(const field *f, int gap)
{
    int count = 0;

    for (int y = 0; y <= f->last; y += gap / 2)
        for (int x = 0; x <= f->last; x += gap / 2)
            count += (x % gap || y % gap) && shown(x, gap, f->ground_x) == x &&
                     shown(y, gap, f->ground_y) == y;
    return count;
}

static long bits_at(const uint8_t *bytes, long first, int count)
{
    long value = 0;

    for (int i = 0; i < count; i++)
        value |= (long)(bytes[(first + i) / 8] >> ((first + i) % 8) & 1) << i;
    return value;
}

static int inflate_all(const uint8_t *from, size_t bytes, uint8_t *to, size_t expected)
{
    z_stream z;
    int rc;

    memset(&z, 0, sizeof(z));
    if (inflateInit2(&z, -15) != Z_OK) return -1;
    z.next_in = (z_const Bytef *)from;
    z.avail_in = (uInt)bytes;
    z.next_out = to;
    z.avail_out = (uInt)expected;
    rc = inflate(&z, Z_FINISH);
    inflateEnd(&z);
    return rc == Z_STREAM_END && z.avail_in == 0 && z.avail_out == 0 ? 0 : -1;
}

/* High parts of kind 3: runs of ones, each ended by a zero. Bytes used, or -1. */
static long unary_all(const uint8_t *bytes, long left, long *high, int count)
{
    long bit = 0;

    for (int i = 0; i < count; i++) {
        for (high[i] = 0; bit < 8 * left && bits_at(bytes, bit, 1) == 1; bit++) high[i]++;
        if (bit++ >= 8 * left) return -1;
    }
    return (bit + 7) / 8;
}

/* `codec` 2 has no kind 2. */
static int body(int codec, int head, const uint8_t *bytes, long left, long *residual, int count)
{
    static uint8_t deflated[SIDE_MAX * SIDE_MAX];
    static long high[SIDE_MAX * SIDE_MAX];
    int kind = head & 3, detail = head >> 4;
    int low_bits = kind == 1 ? detail + 1 : detail;
    long low_bytes = ((long)count * low_bits + 7) / 8;

    if ((kind == 0 && detail != 0) || (kind == 2 && codec == 2) || left < low_bytes ||
        (kind < 2 && left != low_bytes))
        return -1;
    memset(high, 0, sizeof(high));
    if (kind == 2) {
        if (inflate_all(bytes + low_bytes, (size_t)(left - low_bytes), deflated, (size_t)count) !=
            0)
            return -1;
        for (int i = 0; i < count; i++) high[i] = deflated[i];
    }
    if (kind == 3 &&
        unary_all(bytes + low_bytes, left - low_bytes, high, count) != left - low_bytes)
        return -1;
    for (int i = 0; i < count; i++) {
        long value = (high[i] << low_bits) + bits_at(bytes, (long)i * low_bits, low_bits);
        if (value > 65535) return -1;
        residual[i] = value % 2 ? -(value + 1) / 2 : value / 2;
    }
    return 0;
}

/* `stored` error codes; `count` values of 16 bits, signed after the first `corners`. 0 or -1. */
static int plain_part(const uint8_t *at, long left, int stored, int corners, long *residual,
                      int count)
{
    if (left < stored + 2 * count) return -1;
    for (int i = 0; i < stored; i++)
        if (*at++ > 208) return -1;
    for (int i = 0; i < count; i++, at += 2) {
        residual[i] = at[0] + 256L * at[1];
        if (i >= corners && residual[i] >= 32768) residual[i] -= 65536;
    }
    return 0;
}

/* Takes the byte of a mark off, when it is there: one bit a child. */
static int mark_part(const uint8_t *at, long left, int mark, int *used)
{
    if (left <= *used || at[*used] < mark + 1 || at[*used] > mark + 15) return 0;
    return at[(*used)++] - mark;
}

/* What bytes before the error codes say: 256 times the children that are stubs, 16 times those that
 * are leaves, and those that are filled. *used: how many there are. -1 when they may not be. */
static int marks_part(int root, const uint8_t *at, long left, int *used)
{
    int stub, leaf, filled;

    *used = 0;
    stub = mark_part(at, left, 208, used);
    leaf = mark_part(at, left, 224, used);
    filled = mark_part(at, left, 240, used);
    if (root && (stub > 1 || leaf > 1 || filled > 1)) return -1;
    for (int child = 1; child < 16; child *= 2)
        if (stub / child % 2 && leaf / child % 2) return -1;
    return 256 * stub + 16 * leaf + filled;
}

static int raw(int root, const uint8_t *at, long left, long *residual, int count)
{
    int errors = root ? 1 : 4, more, marks = marks_part(root, at, left, &more);

    if (marks < 0 || left != more + errors + 2 * count) return -1;
    return plain_part(at + more, left - more, errors, root ? 4 : 0, residual, count) ? -1 : marks;
}

/* Head, error codes and corners of all codecs but raw. Gives the marks, and how many bytes stand
 * before the body. */
static int front(int root, const uint8_t *at, long left, long *corner, long *before)
{
    int form = at[0] >> 2 & 3, corners = root ? 4 : 0;
    int stored = form == 0 || form == 3 ? 0 : form == 1 || root ? 1 : 4, more = 0;
    int marks = stored      ? marks_part(root, at + 1, left - 1, &more)
                : form == 0 ? 0
                : root      ? 16
                            : 240;
    int first = 1 + more;

    if (marks < 0 || plain_part(at + first, left - first, stored, corners, corner, corners) != 0)
        return -1;
    *before = first + stored + 2 * corners;
    return marks;
}

static int head_and_body(int codec, int root, const uint8_t *at, long left, long *residual,
                         int count)
{
    int corners = root ? 4 : 0;
    long before = 0;
    int marks = front(root, at, left, residual, &before);

    if (marks < 0) return -1;
    return body(codec, at[0], at + before, left - before, residual + corners, count - corners)
               ? -1
               : marks;
}

/* All residuals of a payload, corners first; gives the marks. */
static int residuals(int codec, int root, const uint8_t *at, long left, long *residual, int count)
{
    if (left < 1) return -1;
    switch (codec) {
        case 0: return raw(root, at, left, residual, count);
        case 1:
        case 2: return head_and_body(codec, root, at, left, residual, count);
        default: return -1;
    }
}

int slow_decode(const ff_terrain_info *info, const uint16_t *parent, const uint8_t *payload,
                size_t bytes, uint16_t *heights)
{
    int cells = (parent ? 2 : 1) << info->node_log2;

    return slow_decode_part(info, cells, cells, parent, payload, bytes, heights);
}

int slow_decode_part(const ff_terrain_info *info, int columns, int rows, const uint16_t *parent,
                     const uint8_t *payload, size_t bytes, uint16_t *heights)
{
    static long residual[SIDE_MAX * SIDE_MAX];
    static field f;
    int node = 1 << info->node_log2, count = (node + 1) * (node + 1), values = 4, marks;

    if (info->codec == 3)
        return slow_trained(info, columns, rows, parent, payload, (long)bytes, heights);
    f.last = parent ? 2 * node : node;
    f.maximum_error = info->max_error;
    f.residual = residual;
    f.ground_x = columns;
    f.ground_y = rows;
    if (parent) values = told(&f, 2);
    for (int gap = node; gap > 1 && !parent; gap /= 2) values += told(&f, gap);
    marks = residuals(info->codec, !parent, payload, (long)bytes, residual, values);
    if (marks < 0) return -1;
    if (parent) {
        for (int i = 0; i < count; i++)
            f.height[2 * (i / (node + 1))][2 * (i % (node + 1))] = parent[i];
        double_resolution(&f, 2);
    } else {
        for (int corner = 0; corner < 4; corner++) add(&f, corner % 2 * node, corner / 2 * node, 0);
        for (int gap = node; gap > 1; gap /= 2) double_resolution(&f, gap);
    }
    for (int i = 0; i < (f.last + 1) * (f.last + 1); i++)
        heights[i] = (uint16_t)f.height[i / (f.last + 1)][i % (f.last + 1)];
    return marks;
}
