#include "bake_bare.h"

#include "../../../protocol/shape/ff_shape.h"
#include "../bake_enlarge.h"
#include "../bake_say.h"
#include "bake_image_local.h"
#include "bake_open.h"
#include "bake_texture.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define RGB        3
#define BLOCK      8
#define NEAR_ABOVE 4 /* mean square that nobody sees */
/* of mean squares: 1.25 of their roots */
#define WORSE      25
#define WORSE_THAN 16
#define OPEN_ROOT  0xF0

/* What is at work: the levels of the branch that is looked at. */
typedef struct sifter {
    bake_image *image;
    const ff_terrain_info *info;
    int quality;
    size_t bytes; /* of an image */
    uint8_t *lattice, *enlarged;
    bake_texture_room room;
    uint8_t *decoded[BAKE_TEXTURE_LEVELS_MAX]; /* a level's image as clients see it */
} sifter;

/* ---- marks ---- */

static int read_mark(const bake_image *image, const ff_terrain_info *info, ff_key key,
                     uint8_t *mark)
{
    ff_sheet at;
    int has = bake_image_has(image, info, key, &at);
    FF_ASSERT(has);
    return bake_grid_read(&image->bare[ff_key_level(key)], at.y, at.x, 1, mark);
}

/* A node's mark has ff_image_marks.bare in its low bits, .open in its high ones. */
static ff_image_marks marks_of(uint8_t mark)
{
    return (ff_image_marks){ mark & 15u, mark >> 4 & 15u };
}

int bake_bare_of(const bake_image *image, const ff_terrain_info *info, ff_key key,
                 ff_image_marks *marks)
{
    uint8_t mark = 0;
    ff_sheet at;
    *marks = marks_of(0);
    if (!image->has_bare) return 1;
    if (!bake_image_has(image, info, key, &at)) {
        *marks = marks_of(OPEN_ROOT);
        return ff_key_level(key) == 0;
    }
    int open = ff_key_level(key) ? 0 : bake_is_open(image, info, key);
    if (open < 0) return -1;
    if (!open && ff_key_level(key) + 1 < image->levels && read_mark(image, info, key, &mark))
        return -1;
    *marks = marks_of(open ? OPEN_ROOT : mark);
    for (; ff_key_level(key) > 0; key = ff_key_parent(key)) {
        if (read_mark(image, info, ff_key_parent(key), &mark)) return -1;
        if (ff_image_ends(marks_of(mark), ff_key_quadrant(key))) return 0;
    }
    return 1;
}

static int is_picture(const ff_terrain_info *info) { return info->flags & FF_TERRAIN_PICTURES; }

/* A byte for each node that has ground, of all levels but the last; what is seen of pictures. */
static int open_marks(sifter *s)
{
    uint32_t cells = (1u << s->info->texture_log2) - 1;
    s->image->has_bare = 1;
    for (uint32_t l = 0; l + 1 < s->image->levels; l++) {
        bake_grid *marks = &s->image->bare[l];
        const bake_grid *lattice = &s->image->lattice[l];
        if (bake_grid_open(marks, (lattice->width - 1) / cells, (lattice->height - 1) / cells, 1))
            return -1;
        if (ftruncate(marks->fd, (off_t)marks->width * marks->height))
            return bake_fail("cannot make a temporary file: %s", strerror(errno));
        if (is_picture(s->info) && bake_grid_open(&s->image->seen[l], marks->width * (cells + 1),
                                                  marks->height * (cells + 1), RGB))
            return -1;
    }
    return 0;
}

/* ---- how near ---- */

static uint64_t squares(const uint8_t *a, const uint8_t *b, uint32_t side)
{
    uint64_t sum = 0;
    for (uint32_t j = 0; j < BLOCK; j++)
        for (uint32_t i = 0; i < BLOCK * RGB; i++) {
            int off = a[(size_t)j * side * RGB + i] - b[(size_t)j * side * RGB + i];
            sum += (uint64_t)(off * off);
        }
    return sum;
}

/* Is the enlarged image about as near to the lattice as the one decoded? */
static int is_near(const sifter *s, const uint8_t *decoded)
{
    uint32_t side = 1u << s->info->texture_log2;
    for (uint32_t row = 0; row < side; row += BLOCK)
        for (uint32_t column = 0; column < side; column += BLOCK) {
            size_t at = ((size_t)row * side + column) * RGB;
            uint64_t above = squares(s->enlarged + at, s->lattice + at, side);
            if (above > NEAR_ABOVE * BLOCK * BLOCK * RGB &&
                above * WORSE_THAN > squares(decoded + at, s->lattice + at, side) * WORSE)
                return 0;
        }
    return 1;
}

/* Makes a node's image: its lattice, and what clients see of it. Its parent's is made already. */
static int make_image(sifter *s, ff_key key)
{
    uint32_t level = ff_key_level(key);
    bake_texture_above above = { level ? s->decoded[level - 1] : NULL,
                                 level ? ff_key_quadrant(key) : 0 };
    if (bake_texture_read(s->image, s->info, key, s->lattice) ||
        bake_texture_code(&s->room, s->info, s->quality, above, s->lattice, s->decoded[level]) < 0)
        return -1;
    if (!is_picture(s->info) || level + 1 == s->image->levels) return 0;
    return bake_texture_seen(s->image, s->info, key, 1, s->decoded[level]);
}

/* 1 when the image of a node, or one below it, shows more than that of `above`, or one of them is
 * open; -1 (said). Its own is made unless it is open. */
static int shows_more(sifter *s, ff_key key, ff_key above)
{
    int open = bake_is_open(s->image, s->info, key);
    if (open) return open;
    if (make_image(s, key)) return -1;
    bake_enlarge(s->info, s->decoded[ff_key_level(above)], above, key, s->enlarged);
    if (!is_near(s, s->decoded[ff_key_level(key)])) return 1;
    if (ff_key_level(key) + 1 == s->image->levels) return 0;
    for (uint32_t q = 0; q < 4; q++) {
        ff_key child = ff_key_child(key, q);
        int more = ff_shape_has_ground(s->info, child) ? shows_more(s, child, above) : 0;
        if (more) return more;
    }
    return 0;
}

static int write_mark(const sifter *s, ff_key key, uint8_t mark)
{
    ff_sheet at;
    if (ff_key_level(key) + 1 == s->image->levels || !bake_image_has(s->image, s->info, key, &at))
        return 0;
    return bake_grid_write(&s->image->bare[ff_key_level(key)], at.y, at.x, 1, &mark);
}

/* Marks a node whose image is made, and all below it. */
static int sift(sifter *s, ff_key key)
{
    uint8_t mark = 0;
    if (ff_key_level(key) + 1 == s->image->levels) return 0;
    for (uint32_t q = 0; q < 4; q++) {
        ff_key child = ff_key_child(key, q);
        if (!ff_shape_has_ground(s->info, child)) continue;
        int open = bake_is_open(s->image, s->info, child);
        int more = open ? 0 : shows_more(s, child, key);
        if (open < 0 || more < 0) return -1;
        if (!more) mark |= (uint8_t)((open ? 16u : 1u) << q);
        if (more && sift(s, child)) return -1;
    }
    return write_mark(s, key, mark);
}

static int sift_tile(sifter *s, uint32_t tile)
{
    ff_key root = ff_key_make(tile, 0, 0);
    int open = bake_is_open(s->image, s->info, root);
    if (open) return open < 0 ? -1 : write_mark(s, root, OPEN_ROOT);
    return make_image(s, root) ? -1 : sift(s, root);
}

static int sift_tiles(sifter *s)
{
    uint32_t tiles = ff_shape_tiles(s->info);
    for (uint32_t tile = 0; tile < tiles; tile++) {
        if (sift_tile(s, tile)) return -1;
        bake_progress("images", tile + 1, tiles);
    }
    return 0;
}

int bake_bare_find(bake_image *image, const ff_terrain_info *info, int quality)
{
    sifter s = { .image = image,
                 .info = info,
                 .quality = quality,
                 .bytes = (size_t)RGB << 2 * info->texture_log2 };
    s.lattice = malloc(s.bytes);
    s.enlarged = malloc(s.bytes);
    int rc = bake_texture_room_make(&s.room, info);
    if (!rc && !(s.lattice && s.enlarged)) rc = bake_fail("out of memory");
    for (uint32_t l = 0; !rc && l < image->levels; l++) {
        s.decoded[l] = malloc(s.bytes);
        if (!s.decoded[l]) rc = bake_fail("out of memory");
    }
    if (!rc) rc = open_marks(&s);
    if (!rc) rc = sift_tiles(&s);
    for (uint32_t l = 0; l < image->levels; l++) free(s.decoded[l]);
    bake_texture_room_free(&s.room);
    free(s.enlarged);
    free(s.lattice);
    return rc;
}
