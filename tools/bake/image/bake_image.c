#include "bake_image.h"

#include "../../../protocol/shape/ff_shape.h"
#include "../../../protocol/ff_image.h"
#include "bake_bare.h"
#include "bake_image_local.h"
#include "bake_nearest.h"
#include "bake_open.h"
#include "bake_own.h"
#include "bake_texture.h"
#include "../bake_say.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The finest level's texels are at most this many image pixels wide. */
#define COARSEST_TEXEL_PX 1.25
#define BEYOND_PX         0.25
#define RGB               3
#define RGBA              4

/* Source rows already filtered along x, kept while the window slides south. */
typedef struct row_ring {
    float *row; /* slots x width x RGBA; colours weighted by alpha, what the image covers (0..1) */
    int64_t *held; /* source row in each slot, -1: none */
    uint32_t slots, width;
    uint8_t *source; /* one row of the image */
} row_ring;

/* The stretch *from .. *to of pixels round a centre, kept inside 0..size and never empty. 0: the
 * centre lies beyond, by more than rounding makes it. */
static int footprint(double centre, double wide, uint32_t size, double *from, double *to)
{
    if (wide < 1) wide = 1;
    if (centre < -BEYOND_PX || centre > size + BEYOND_PX) return 0;
    *from = fmin(fmax(centre - wide / 2, 0), size - 0.5);
    *to = fmax(fmin(centre + wide / 2, size), *from + 0.5);
    return 1;
}

/* Mean of the pixels from..to of a row, each weighted by how much of it is covered. */
static void mean_pixels(const uint8_t *rgba, double from, double to, float *out)
{
    double sum[RGBA] = { 0 }, all = (to - from) * 255;
    for (uint32_t px = (uint32_t)from; px < to; px++) {
        const uint8_t *pixel = rgba + (size_t)RGBA * px;
        double weight = (fmin(px + 1, to) - fmax(px, from)) * pixel[RGB];
        for (int c = 0; c < RGB; c++) sum[c] += weight * pixel[c];
        sum[RGB] += weight;
    }
    for (int c = 0; c < RGBA; c++) out[c] = (float)(sum[c] / all);
}

static const float *filtered_row(const bake_picture *picture, row_ring *ring, uint32_t row,
                                 const bake_texel_place *place)
{
    float *out = ring->row + (size_t)(row % ring->slots) * ring->width * RGBA;
    if (ring->held[row % ring->slots] == row) return out;
    if (bake_picture_row(picture, row, ring->source)) return NULL;
    double px_per_sample = picture->width / (picture->east - picture->west);
    for (uint32_t i = 0; i < ring->width; i++) {
        double from, to, x = fmin((place->first_x + (double)i) * place->samples, place->last_x);
        float *texel = out + (size_t)i * RGBA;
        memset(texel, 0, RGBA * sizeof *texel);
        if (footprint((x - picture->west) * px_per_sample, place->samples * px_per_sample,
                      picture->width, &from, &to))
            mean_pixels(ring->source, from, to, texel);
    }
    ring->held[row % ring->slots] = row;
    return out;
}

/* The memory in which one row of the finest lattice is made. */
typedef struct lattice_row {
    float *sum; /* RGBA */
    uint8_t *rgb;
    uint32_t *distance; /* to the nearest covered texel: bake_nearest.h */
} lattice_row;

/* Makes colours of weighted sums; returns the number of texels that the image covers by half or
 * more. */
static uint64_t finish_row(const lattice_row *out, uint32_t width)
{
    uint64_t covered = 0;
    for (size_t i = 0; i < width; i++) {
        const float *texel = out->sum + i * RGBA;
        int is_covered = texel[RGB] > 1e-4f, is_half = texel[RGB] >= 0.5f;
        for (size_t c = 0; c < RGB; c++)
            out->rgb[i * RGB + c] = is_covered ? (uint8_t)fminf(texel[c] / texel[RGB] + 0.5f, 255)
                                               : 0;
        out->distance[i] = is_half ? 0 : is_covered ? 1 : BAKE_NEAREST_FAR;
        covered += (uint64_t)is_half;
    }
    return covered;
}

/* Sums the rows from..to of the image, weighted, into one row of the finest lattice. */
static int sample_row(const bake_picture *picture, row_ring *ring, double from, double to,
                      const bake_texel_place *place, float *sum)
{
    size_t values = (size_t)ring->width * RGBA;
    memset(sum, 0, values * sizeof *sum);
    for (uint32_t row = (uint32_t)from; row < to; row++) {
        const float *filtered = filtered_row(picture, ring, row, place);
        if (!filtered) return -1;
        float weight = (float)((fmin(row + 1, to) - fmax(row, from)) / (to - from));
        for (size_t i = 0; i < values; i++) sum[i] += weight * filtered[i];
    }
    return 0;
}

/* *covered receives how many texels the image covers. */
static int sample_rows(const bake_picture *picture, row_ring *ring, const bake_texel_place *place,
                       const bake_grid *lattice, const bake_grid *distance, const lattice_row *out,
                       uint64_t *covered)
{
    double px_per_sample = picture->height / (picture->north - picture->south);
    *covered = 0;
    for (uint32_t j = lattice->height; j-- > 0;) {
        double from, to, y = fmin((place->first_y + (double)j) * place->samples, place->last_y);
        if (!footprint((picture->north - y) * px_per_sample, place->samples * px_per_sample,
                       picture->height, &from, &to))
            memset(out->sum, 0, (size_t)RGBA * lattice->width * sizeof *out->sum);
        else if (sample_row(picture, ring, from, to, place, out->sum))
            return -1;
        *covered += finish_row(out, lattice->width);
        if (bake_grid_write(lattice, j, 0, lattice->width, out->rgb)) return -1;
        if (bake_grid_write(distance, j, 0, lattice->width, out->distance)) return -1;
        bake_progress("colour", lattice->height - j, lattice->height);
    }
    return 0;
}

/* Sees to the texels that the image does not cover; `parted`: and it reaches not into all nodes. */
static int fill_open(bake_image *image, const ff_terrain_info *info, bake_own *own,
                     const bake_texel_place *place, const bake_grid *distance, int parted,
                     uint64_t covered)
{
    if (!parted && covered == (uint64_t)distance->width * distance->height) return 0;
    return covered ? bake_open_fill(image, info, own, place, distance) : bake_open_all(image, info);
}

static int sample_image(const bake_picture *picture, const ff_terrain_info *info, bake_own *own,
                        const bake_texel_place *place, int parted, bake_image *image,
                        uint64_t *covered)
{
    const bake_grid *lattice = &image->lattice[image->levels - 1];
    double px_per_sample = picture->height / (picture->north - picture->south);
    row_ring ring = { .slots = (uint32_t)ceil(fmax(1, place->samples * px_per_sample)) + 2,
                      .width = lattice->width };
    lattice_row out = { malloc((size_t)ring.width * RGBA * sizeof(float)),
                        malloc((size_t)ring.width * RGB), malloc(ring.width * sizeof(uint32_t)) };
    bake_grid distance;
    ring.row = malloc((size_t)ring.slots * ring.width * RGBA * sizeof *ring.row);
    ring.held = malloc(ring.slots * sizeof *ring.held);
    ring.source = malloc((size_t)picture->width * RGBA);
    int rc = bake_grid_open(&distance, lattice->width, lattice->height, sizeof(uint32_t));
    if (!rc && !(ring.row && ring.held && ring.source && out.sum && out.rgb && out.distance))
        rc = bake_fail("out of memory");
    for (uint32_t i = 0; !rc && i < ring.slots; i++) ring.held[i] = -1;
    if (!rc) rc = sample_rows(picture, &ring, place, lattice, &distance, &out, covered);
    if (!rc) rc = fill_open(image, info, own, place, &distance, parted, *covered);
    bake_grid_close(&distance);
    free(out.sum);
    free(out.rgb);
    free(out.distance);
    free(ring.row);
    free(ring.held);
    free(ring.source);
    return rc;
}

static uint32_t inside(int64_t at, uint32_t count)
{
    return (uint32_t)(at < 0 ? 0 : at >= count ? (int64_t)count - 1 : at);
}

/* Makes a row of every second point of the finer lattice, which begins `skip` points on, weighted
 * 1-2-1 along both axes; points beyond its rim repeat it. */
static void halve_row(uint8_t *const fine[3], uint32_t fine_width, uint32_t skip,
                      uint32_t coarse_width, uint8_t *out)
{
    for (uint32_t i = 0; i < coarse_width; i++) {
        size_t last = fine_width - 1, at = inside(2 * (int64_t)i - skip, fine_width),
               west = at ? at - 1 : at, east = at < last ? at + 1 : at;
        for (int c = 0; c < RGB; c++) {
            unsigned sum = 8;
            for (int r = 0; r < 3; r++) {
                const uint8_t *row = fine[r] + c;
                sum += (r == 1 ? 2u : 1u) *
                       (row[west * RGB] + 2u * row[at * RGB] + row[east * RGB]);
            }
            out[(size_t)i * RGB + (size_t)c] = (uint8_t)(sum / 16);
        }
    }
}

/* `skip`: how many points the finer lattice begins further on than the coarser one. */
static int halve_lattice(const bake_grid *fine, ff_sheet skip, const bake_grid *coarse)
{
    size_t row_bytes = (size_t)fine->width * RGB;
    uint8_t *memory = malloc(4 * row_bytes);
    if (!memory) return bake_fail("out of memory");
    uint8_t *const rows[3] = { memory, memory + row_bytes, memory + 2 * row_bytes };
    int rc = 0;
    for (uint32_t j = 0; !rc && j < coarse->height; j++) {
        for (int r = 0; !rc && r < 3; r++) {
            uint32_t row = inside(2 * (int64_t)j + r - 1 - skip.y, fine->height);
            rc = bake_grid_read(fine, row, 0, fine->width, rows[r]);
        }
        if (rc) break;
        halve_row(rows, fine->width, skip.x, coarse->width, memory + 3 * row_bytes);
        rc = bake_grid_write(coarse, j, 0, coarse->width, memory + 3 * row_bytes);
    }
    free(memory);
    return rc;
}

static uint32_t choose_levels(const bake_options *o, const bake_picture *picture,
                              const ff_terrain_info *info)
{
    uint32_t most = ff_image_levels(info), levels = 1;
    if (o->texture_levels) return o->texture_levels < most ? o->texture_levels : most;
    double px_per_sample = fmax(picture->width / (picture->east - picture->west),
                                picture->height / (picture->north - picture->south));
    double texel_px = (double)(1u << info->tile_log2) / ((1u << o->texture_log2) - 1) *
                      px_per_sample;
    for (; levels < most && texel_px > COARSEST_TEXEL_PX; levels++) texel_px /= 2;
    return levels;
}

/* Of nodes first..last along an axis those that a picture reaches into. */
static void reach(double low, double high, double edge, uint32_t *first, uint32_t *last)
{
    double from = floor(low / edge), to = floor(high / edge);
    if (to < *first || from > *last) from = to = *first; /* none: it covers nothing */
    if (from > *first) *first = (uint32_t)from;
    if (to < *last) *last = (uint32_t)to;
}

void bake_picture_reach(const bake_picture *picture, double edge, ff_sheet *first, ff_sheet *last)
{
    reach(picture->west, picture->east, edge, &first->x, &last->x);
    reach(picture->south, picture->north, edge, &first->y, &last->y);
}

/* Opens the lattices of nodes first..last of the finest level and those above them. */
static int open_lattices(const ff_terrain_info *info, ff_sheet first, ff_sheet last,
                         bake_image *image)
{
    uint32_t steps = (1u << info->texture_log2) - 1;
    for (uint32_t l = 0; l < image->levels; l++) {
        uint32_t up = image->levels - 1 - l;
        image->first[l] = (ff_sheet){ first.x >> up, first.y >> up };
        if (bake_grid_open(&image->lattice[l], ((last.x >> up) - image->first[l].x + 1) * steps + 1,
                           ((last.y >> up) - image->first[l].y + 1) * steps + 1, RGB))
            return -1;
    }
    return 0;
}

/* Makes coarser lattices of the finest one: `place` is its. What that tells nothing of has the
 * ground's own colours. */
static int halve_lattices(const ff_terrain_info *info, bake_own *own, bake_texel_place place,
                          bake_image *image)
{
    uint32_t steps = (1u << info->texture_log2) - 1;
    for (uint32_t l = image->levels - 1; l > 0; l--) {
        const ff_sheet *first = &image->first[l];
        const ff_sheet skip = { (first->x & 1) * steps, (first->y & 1) * steps };
        place.samples *= 2;
        place.first_x = (place.first_x - skip.x) / 2;
        place.first_y = (place.first_y - skip.y) / 2;
        if (halve_lattice(&image->lattice[l], skip, &image->lattice[l - 1])) return -1;
        if (own && bake_open_beyond(own, &place, &image->lattice[l], skip, &image->lattice[l - 1]))
            return -1;
    }
    return 0;
}

/* The lattices of all levels from that of a node on, as far as nodes have ground: `samples` of it,
 * less one, from the node's first. With `heights` those alone that the picture reaches into. */
static int make_lattices(const bake_picture *picture, const bake_ground *ground,
                         const bake_samples *heights, const ff_terrain_info *info, ff_sheet node,
                         ff_sheet samples, bake_image *image, uint64_t *covered)
{
    uint32_t steps = (1u << info->texture_log2) - 1, top = image->levels - 1,
             edge_log2 = info->tile_log2 - (info->texture_levels - 1u);
    ff_sheet first = { 0, 0 }, all = { (samples.x - 1) >> edge_log2, (samples.y - 1) >> edge_log2 },
             last = all;
    if (heights) bake_picture_reach(picture, 1u << edge_log2, &first, &last);
    bake_texel_place place = { .samples = (double)(1u << edge_log2) / steps,
                               .last_x = ground->grid.width - 1.0,
                               .last_y = ground->grid.height - 1.0,
                               .first_x = ((node.x << top) + first.x) * steps,
                               .first_y = ((node.y << top) + first.y) * steps };
    int parted = first.x || first.y || last.x < all.x || last.y < all.y;
    bake_own *own = heights ? bake_own_open(info, heights) : NULL;
    int rc = heights && !own ? -1 : open_lattices(info, first, last, image);
    if (!rc) rc = sample_image(picture, info, own, &place, parted, image, covered);
    if (!rc) rc = halve_lattices(info, parted ? own : NULL, place, image);
    bake_own_close(own);
    return rc;
}

static void choose_textures(const bake_options *o, const bake_picture *picture,
                            ff_terrain_info *info)
{
    info->texture_log2 = (uint8_t)o->texture_log2;
    info->texture_levels = (uint8_t)choose_levels(o, picture, info);
    if (!o->image_codec) info->flags |= FF_TERRAIN_PICTURES;
}

int bake_picture_levels(const bake_options *o, const bake_ground *ground, ff_terrain_info *info,
                        bake_picture *picture)
{
    if (bake_picture_open(o, ground, picture)) return -1;
    choose_textures(o, picture, info);
    return 0;
}

static void open_image(bake_image *image, uint32_t levels)
{
    for (int l = 0; l < BAKE_TEXTURE_LEVELS_MAX; l++)
        image->lattice[l] = image->bare[l] = image->seen[l] = image->open[l] = BAKE_GRID_CLOSED;
    image->has_bare = image->has_open = 0;
    image->levels = levels;
}

int bake_image_part(const bake_picture *picture, const bake_ground *ground,
                    const ff_terrain_info *info, uint32_t level, ff_sheet node, bake_image *image)
{
    uint64_t covered;
    uint32_t edge = 1u << (info->tile_log2 - level);
    open_image(image, info->texture_levels - level);
    return make_lattices(picture, ground, NULL, info, node, (ff_sheet){ edge, edge }, image,
                         &covered);
}

/* All of the image, of the levels that info tells. */
static int make_image(const bake_options *o, const bake_picture *picture, const bake_ground *ground,
                      const bake_samples *heights, const ff_terrain_info *info, bake_image *image)
{
    uint64_t covered;
    ff_sheet samples = { ground->grid.width - 1, ground->grid.height - 1 };
    image->levels = info->texture_levels;
    if (make_lattices(picture, ground, heights, info, (ff_sheet){ 0, 0 }, samples, image, &covered))
        return -1;
    if (!covered) return bake_fail("the image shows nothing of this ground");
    return bake_bare_find(image, info, (int)o->texture_quality);
}

int bake_image_make(const bake_options *o, const bake_ground *ground, const bake_samples *heights,
                    ff_terrain_info *info, bake_image *image)
{
    bake_picture picture;
    open_image(image, 0);
    if (bake_picture_levels(o, ground, info, &picture)) return -1;
    int rc = make_image(o, &picture, ground, heights, info, image);
    bake_picture_close(&picture);
    return rc;
}

int bake_image_lay(const bake_options *o, GDALDatasetH set, const bake_ground *ground,
                   const bake_samples *heights, ff_terrain_info *info, bake_image *image)
{
    bake_picture picture = bake_picture_of(ground, set);
    open_image(image, 0);
    choose_textures(o, &picture, info);
    return make_image(o, &picture, ground, heights, info, image);
}

void bake_image_close(bake_image *image)
{
    for (uint32_t l = 0; l < image->levels; l++) {
        bake_grid_close(&image->lattice[l]);
        if (image->has_bare) bake_grid_close(&image->bare[l]);
        if (image->has_bare) bake_grid_close(&image->seen[l]);
        if (image->has_open) bake_grid_close(&image->open[l]);
    }
    image->levels = 0;
}

/* ---- textures of nodes ---- */

int bake_image_has(const bake_image *image, const ff_terrain_info *info, ff_key key, ff_sheet *at)
{
    uint32_t level = ff_key_level(key), code = ff_key_code(key),
             steps = (1u << info->texture_log2) - 1;
    ff_sheet tile = ff_shape_sheet(info, ff_key_tile(key)), first = image->first[level];
    const bake_grid *lattice = &image->lattice[level];
    *at = (ff_sheet){ (tile.x << level) + ff_morton_x(code) - first.x,
                      (tile.y << level) + ff_morton_y(code) - first.y };
    return at->x < (lattice->width - 1) / steps && at->y < (lattice->height - 1) / steps;
}

int bake_texture_read(const bake_image *image, const ff_terrain_info *info, ff_key key,
                      uint8_t *rgb)
{
    uint32_t side = 1u << info->texture_log2, level = ff_key_level(key);
    ff_sheet at;
    int has = bake_image_has(image, info, key, &at);
    FF_ASSERT(has);
    uint32_t column = at.x * (side - 1), row = at.y * (side - 1);
    for (uint32_t j = 0; j < side; j++)
        if (bake_grid_read(&image->lattice[level], row + j, column, side,
                           rgb + (size_t)(side - 1 - j) * side * RGB))
            return -1;
    return 0;
}

int bake_texture_seen(const bake_image *image, const ff_terrain_info *info, ff_key key, int put,
                      uint8_t *rgb)
{
    uint32_t side = 1u << info->texture_log2, level = ff_key_level(key);
    ff_sheet at;
    int has = bake_image_has(image, info, key, &at);
    FF_ASSERT(has);
    uint32_t column = at.x * side, row = at.y * side;
    const bake_grid *grid = &image->seen[level];
    int rc = 0;
    for (uint32_t j = 0; !rc && j < side; j++, rgb += (size_t)side * RGB)
        rc = put ? bake_grid_write(grid, row + j, column, side, rgb)
                 : bake_grid_read(grid, row + j, column, side, rgb);
    return rc;
}

/* What encoding takes: a node's lattice, what is seen of its parent's, and what is coded. */
typedef struct encoder {
    const bake_image *image;
    const ff_terrain_info *info;
    int quality;
    uint8_t *rgb, *above, *decoded;
    bake_texture_room room;
    bake_blob *blob;
} encoder;

static int find_above(const encoder *e, ff_key key, bake_texture_above *above)
{
    *above = (bake_texture_above){ 0 };
    if (!ff_key_level(key) || !(e->info->flags & FF_TERRAIN_PICTURES)) return 0;
    *above = (bake_texture_above){ e->above, ff_key_quadrant(key) };
    return bake_texture_seen(e->image, e->info, ff_key_parent(key), 0, e->above);
}

/* A node's image, and before it which children have none, as packs have them. */
static int encode_texture(const encoder *e, ff_key key)
{
    bake_texture_above above;
    ff_image_marks marks;
    if (!ff_shape_has_ground(e->info, key)) return bake_blob_add(e->blob, NULL, 0);
    int has = bake_bare_of(e->image, e->info, key, &marks);
    if (has <= 0) return has ? -1 : bake_blob_add(e->blob, NULL, 0);
    size_t before = ff_image_put_marks(marks, e->room.coded);
    if (marks.open == 15) return bake_blob_add(e->blob, e->room.coded, before);
    if (bake_texture_read(e->image, e->info, key, e->rgb) || find_above(e, key, &above)) return -1;
    int bytes = bake_texture_code(&e->room, e->info, e->quality, above, e->rgb, e->decoded);
    if (bytes < 0) return -1;
    memmove(e->room.coded + before, e->room.coded, (size_t)bytes);
    ff_image_put_marks(marks, e->room.coded);
    return bake_blob_add(e->blob, e->room.coded, before + (size_t)bytes);
}

int bake_texture_encode(const bake_image *image, const ff_terrain_info *info, int quality,
                        ff_key node, uint32_t below, bake_blob *blob)
{
    uint32_t level = ff_key_level(node) + below;
    encoder e = { .image = image, .info = info, .quality = quality, .blob = blob };
    e.rgb = malloc((size_t)RGB << 2 * info->texture_log2);
    e.above = malloc((size_t)RGB << 2 * info->texture_log2);
    e.decoded = malloc((size_t)RGB << 2 * info->texture_log2);
    int rc = bake_texture_room_make(&e.room, info);
    if (!rc && !(e.rgb && e.above && e.decoded)) rc = bake_fail("out of memory");
    for (uint32_t i = 0; !rc && i >> (2 * below) == 0; i++)
        rc = encode_texture(
            &e, ff_key_make(ff_key_tile(node), level, ff_key_code(node) << 2 * below | i));
    bake_texture_room_free(&e.room);
    free(e.decoded);
    free(e.above);
    free(e.rgb);
    return rc;
}
