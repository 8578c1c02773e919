#include "bake_image_sample.h"

#include "../../../platform/sys.h"
#include "bake_bare.h"
#include "bake_image_local.h"

#include <math.h>

#define PART_LEVELS 3 /* of a part: 21 textures */
#define PARTS_SIDE  4u

/* Parts that are made, of so many nodes of their level. */
typedef struct stratum {
    ff_sheet first, size;
    double bytes, squares, root_bytes;
    uint32_t made;
} stratum;

/* What all parts share. */
typedef struct sampling {
    const bake_options *options;
    const bake_ground *ground;
    const ff_terrain_info *info;
    bake_picture picture;
    uint32_t level; /* of the parts' topmost texture */
    double lattice_s, encode_s;
} sampling;

static double now_s(void) { return (double)sys_time_us() / 1e6; }

/* Bytes of all JPEGs of a part: of its topmost one, and of all. */
static int encode_part(const sampling *s, bake_image *image, double *root, double *all)
{
    ff_terrain_info one = *s->info;
    bake_blob blob = { 0 };
    int rc = 0;
    uint32_t side = (1u << one.tile_log2) + 1;
    ff_shape_cover(&one, side, side); /* the only tile */
    *all = 0;
    rc = bake_bare_find(image, &one, (int)s->options->texture_quality);
    for (uint32_t l = 0; !rc && l < image->levels; l++) {
        bake_blob_clear(&blob);
        rc = bake_texture_encode(image, &one, s->options->texture_quality, ff_key_make(0, 0, 0), l,
                                 &blob);
        *all += (double)blob.byte_count;
        if (!l) *root = (double)blob.byte_count;
    }
    bake_blob_free(&blob);
    return rc;
}

static int make_part(sampling *s, ff_sheet node, stratum *of)
{
    bake_image image = { .levels = 0 };
    double root = 0, all = 0, started_s = now_s();
    int rc = bake_image_part(&s->picture, s->ground, s->info, s->level, node, &image);
    double made_s = now_s();
    if (!rc) rc = encode_part(s, &image, &root, &all);
    bake_image_close(&image);
    s->lattice_s += made_s - started_s;
    s->encode_s += now_s() - made_s;
    of->bytes += all;
    of->squares += all * all;
    of->root_bytes += root;
    of->made++;
    return rc;
}

/* At most `side` parts each way, in the middle of as many equal fields; from north to south, as
 * images are read. */
static int make_stratum(sampling *s, uint32_t side, stratum *of)
{
    uint32_t columns = of->size.x < side ? of->size.x : side,
             rows = of->size.y < side ? of->size.y : side;
    for (uint32_t j = rows; j-- > 0;)
        for (uint32_t i = 0; i < columns; i++) {
            ff_sheet node = { of->first.x + (2 * i + 1) * of->size.x / (2 * columns),
                              of->first.y + (2 * j + 1) * of->size.y / (2 * rows) };
            if (make_part(s, node, of)) return -1;
        }
    return 0;
}

/* Adds what all parts of a stratum will take, and the coarser textures above them. */
static void add_up(const sampling *s, const stratum *of, bake_image_guess *guess)
{
    double all = (double)of->size.x * of->size.y, n = of->made;
    if (!of->made) return;
    double mean = of->bytes / n, spread = fmax(0, of->squares / n - mean * mean);
    double above = (1 - pow(0.25, s->level)) / 3; /* 1/4 + 1/16 .. of a part's topmost texture */
    guess->bytes += all * (mean + above * of->root_bytes / n);
    if (n > 1)
        guess->deviation = hypot(guess->deviation, all * sqrt(spread / (n - 1) * (1 - n / all)));
    guess->share += n;
}

static int sample(sampling *s, bake_image_guess *guess)
{
    uint32_t edge = 1u << (s->info->tile_log2 - s->level);
    ff_sheet last = { (s->ground->grid.width - 2) / edge, (s->ground->grid.height - 2) / edge };
    double all = (last.x + 1.0) * (last.y + 1.0);
    stratum part = { .made = 0 };
    bake_picture_reach(&s->picture, edge, &part.first, &last);
    part.size = (ff_sheet){ last.x - part.first.x + 1, last.y - part.first.y + 1 };
    *guess = (bake_image_guess){ .reach = (double)part.size.x * part.size.y / all };
    if (make_stratum(s, PARTS_SIDE, &part)) return -1;
    add_up(s, &part, guess);
    guess->share /= (double)part.size.x * part.size.y;
    guess->lattice_s = s->lattice_s / guess->share;
    guess->encode_s = s->encode_s / guess->share;
    return 0;
}

int bake_image_sample(const bake_options *o, const bake_ground *ground, ff_terrain_info *info,
                      bake_image_guess *guess)
{
    sampling s = { .options = o, .ground = ground, .info = info };
    if (bake_picture_levels(o, ground, info, &s.picture)) return -1;
    s.level = info->texture_levels > PART_LEVELS ? info->texture_levels - (uint32_t)PART_LEVELS : 0;
    int rc = sample(&s, guess);
    bake_picture_close(&s.picture);
    return rc;
}
