#include "bake_tiles.h"

#include "../../protocol/shape/ff_shape.h"
#include "bake_jobs.h"
#include "bake_say.h"

#include <stdlib.h>

/* What each worker has of its own. */
typedef struct worker {
    bake_top top;
    bake_block block;
    bake_off off;
    bake_blob texture[BAKE_TEXTURE_LEVELS_MAX]; /* that its block makes */
} worker;

/* What blocks have told of the tile that is under way, and their records that wait for it. */
typedef struct gathered {
    bake_known *known; /* of all nodes down to the blocks': bake_top_number */
    bake_blob below;   /* refinements of the blocks' nodes */
    bake_blob texture[BAKE_TEXTURE_LEVELS_MAX]; /* down to the blocks' nodes */
} gathered;

typedef struct crew {
    const bake_tiles *tiles;
    worker *worker;
    gathered gathered;
    uint32_t bottom, blocks; /* of a tile: the blocks' level, and how many, those of padding too */
    uint32_t levels;         /* sections of heights */
} crew;

static ff_key key_of(const crew *c, uint32_t job)
{
    return ff_key_make(job / c->blocks, c->bottom, job % c->blocks);
}

static int is_last(const crew *c, uint32_t job) { return job % c->blocks == c->blocks - 1; }

/* 1 when the block is the first one of its ancestor of a level. */
static int is_first(const crew *c, ff_key key, uint32_t level)
{
    return (ff_key_code(key) & ((1u << 2 * (c->bottom - level)) - 1)) == 0;
}

static ff_key ancestor(ff_key key, uint32_t level)
{
    while (ff_key_level(key) > level) key = ff_key_parent(key);
    return key;
}

/* Textures of the block's nodes, and of those above of which it is the first block. */
static int make_textures(const crew *c, worker *w, ff_key key)
{
    const bake_tiles *t = c->tiles;
    for (uint32_t l = 0; l < t->image->levels; l++) {
        bake_blob_clear(&w->texture[l]);
        if (l < c->bottom && !is_first(c, key, l)) continue;
        if (bake_texture_encode(t->image, t->info, t->texture_quality, ancestor(key, l),
                                l < c->bottom ? 0 : l - c->bottom, &w->texture[l]))
            return -1;
    }
    return 0;
}

static int make_block(void *context, int number, uint32_t job)
{
    crew *c = context;
    const bake_tiles *t = c->tiles;
    worker *w = &c->worker[number];
    ff_key key = key_of(c, job);
    int has_ground = ff_shape_has_ground(t->info, key);
    if (!has_ground && !is_last(c, job)) return 0;
    if (t->images_only) return has_ground ? make_textures(c, w, key) : 0;
    if (bake_top_load(&w->top, t->samples, ff_key_tile(key))) return -1;
    if (!has_ground) return 0;
    if (bake_block_load(&w->block, t->samples, key) || bake_block_encode(&w->block, &w->top))
        return -1;
    if (t->off) w->off = bake_block_off(&w->block);
    return make_textures(c, w, key);
}

/* ---- in order ---- */

static void start_tile(crew *c)
{
    gathered *g = &c->gathered;
    size_t count = bake_top_number(ff_key_make(0, c->bottom, 0)) + c->blocks;
    for (size_t i = 0; i < count; i++) g->known[i] = (bake_known){ .leaf = 1 }; /* padding */
    bake_blob_clear(&g->below);
    for (uint32_t l = 0; l < BAKE_TEXTURE_LEVELS_MAX; l++) bake_blob_clear(&g->texture[l]);
}

/* Adds what a block tells of its node and of those above. */
static void gather_known(crew *c, const bake_block *block)
{
    for (uint32_t l = 0; l <= c->bottom; l++) {
        bake_known *node = &c->gathered.known[bake_top_number(ancestor(block->key, l))];
        const bake_known *more = &block->above[l];
        if (more->code > node->code) node->code = more->code;
        node->filled |= more->filled;
        if (l == c->bottom) node->leaf = more->leaf;
    }
}

static void gather_off(const crew *c, const worker *w)
{
    bake_off *off = c->tiles->off;
    if (!off) return;
    off->squares += w->off.squares;
    off->samples += w->off.samples;
}

/* Textures of the block's node and of those above; none where there is no ground. */
static int gather_textures(crew *c, const worker *w, ff_key key, int has_ground)
{
    static const bake_blob none;
    for (uint32_t l = 0; l < c->tiles->image->levels && l <= c->bottom; l++) {
        const bake_blob *blob = has_ground ? &w->texture[l] : &none;
        if (!is_first(c, key, l)) continue;
        if (bake_blob_add(&c->gathered.texture[l], blob->bytes, blob->byte_count)) return -1;
    }
    return 0;
}

static int take(const crew *c, uint32_t section, const bake_blob *records, const bake_blob *above)
{
    return c->tiles->take(c->tiles->context, section, records, above);
}

/* What is below the block's node can go where it belongs. */
static int take_below(const crew *c, const worker *w)
{
    const bake_blob *level = w->block.levels.level, *texture = w->texture;
    for (uint32_t l = c->bottom + 2;
         !c->tiles->images_only && l < c->levels && level[l].record_count; l++)
        if (take(c, l, &level[l], &level[l - 1])) return -1;
    for (uint32_t l = c->bottom + 1; l < c->tiles->image->levels; l++)
        if (take(c, c->levels + l, &texture[l], &texture[l - 1])) return -1;
    return 0;
}

static int take_top_heights(crew *c, worker *w)
{
    const gathered *g = &c->gathered;
    const bake_blob *level = w->top.levels.level;
    if (bake_top_encode(&w->top, g->known) || take(c, 0, &level[0], NULL)) return -1;
    for (uint32_t l = 1; l <= c->bottom; l++)
        if (take(c, l, &level[l], &level[l - 1])) return -1;
    return c->bottom + 1 < c->levels && take(c, c->bottom + 1, &g->below, &level[c->bottom]) ? -1
                                                                                             : 0;
}

/* The top of the tile, when all of its blocks are taken. Roots have all their places. */
static int take_top(crew *c, worker *w)
{
    const gathered *g = &c->gathered;
    if (!c->tiles->images_only && take_top_heights(c, w)) return -1;
    for (uint32_t l = 0; l < c->tiles->image->levels && l <= c->bottom; l++)
        if (take(c, c->levels + l, &g->texture[l], l ? &g->texture[l - 1] : NULL)) return -1;
    return 0;
}

static int take_block(void *context, int number, uint32_t job)
{
    crew *c = context;
    worker *w = &c->worker[number];
    ff_key key = key_of(c, job);
    int has_ground = ff_shape_has_ground(c->tiles->info, key);
    const bake_blob *own = &w->block.levels.level[c->bottom + 1];
    if (!ff_key_code(key)) start_tile(c);
    if (gather_textures(c, w, key, has_ground)) return -1;
    if (!c->tiles->images_only && c->bottom + 1 < c->levels &&
        bake_blob_add(&c->gathered.below, has_ground ? own->bytes : NULL,
                      has_ground ? own->byte_count : 0))
        return -1;
    if (has_ground) {
        if (!c->tiles->images_only) gather_known(c, &w->block);
        if (!c->tiles->images_only) gather_off(c, w);
        if (take_below(c, w)) return -1;
    }
    return is_last(c, job) ? take_top(c, w) : 0;
}

/* ---- all ---- */

static int open_crew(crew *c, const bake_tiles *tiles, uint32_t workers)
{
    bake_top *top;
    c->tiles = tiles;
    c->levels = ff_terrain_levels(tiles->info);
    c->worker = calloc(workers, sizeof *c->worker);
    int rc = c->worker ? 0 : bake_fail("out of memory");
    for (uint32_t i = 0; !rc && i < workers; i++) {
        top = &c->worker[i].top;
        rc = bake_top_open(top, tiles->info, tiles->block_log2) ||
                     bake_block_open(&c->worker[i].block, top)
                 ? -1
                 : 0;
        c->bottom = bake_top_bottom(top);
        c->blocks = 1u << 2 * c->bottom;
    }
    size_t nodes = rc ? 0 : bake_top_number(ff_key_make(0, c->bottom, 0)) + c->blocks;
    c->gathered.known = rc ? NULL : malloc(nodes * sizeof *c->gathered.known);
    return rc || c->gathered.known ? rc : bake_fail("out of memory");
}

static void close_crew(crew *c, uint32_t workers)
{
    for (uint32_t i = 0; c->worker && i < workers; i++) {
        bake_block_close(&c->worker[i].block);
        bake_top_close(&c->worker[i].top);
        for (uint32_t l = 0; l < BAKE_TEXTURE_LEVELS_MAX; l++)
            bake_blob_free(&c->worker[i].texture[l]);
    }
    for (uint32_t l = 0; l < BAKE_TEXTURE_LEVELS_MAX; l++) bake_blob_free(&c->gathered.texture[l]);
    bake_blob_free(&c->gathered.below);
    free(c->gathered.known);
    free(c->worker);
}

/* Blocks of all tiles, those of padding too. */
static uint64_t count_blocks(const ff_terrain_info *info, uint32_t block_log2)
{
    uint32_t bottom = info->tile_log2 > block_log2 ? info->tile_log2 - block_log2 : 0;
    return (uint64_t)ff_shape_tiles(info) << 2 * bottom;
}

uint32_t bake_tiles_workers(const ff_terrain_info *info, uint32_t block_log2, uint32_t jobs)
{
    uint64_t blocks = count_blocks(info, block_log2);
    return jobs < blocks ? jobs : (uint32_t)blocks;
}

int bake_tiles_make(const bake_tiles *tiles)
{
    uint32_t workers = bake_tiles_workers(tiles->info, tiles->block_log2, tiles->jobs);
    uint64_t blocks = count_blocks(tiles->info, tiles->block_log2);
    crew c = { .levels = 0 };
    if (blocks > UINT32_MAX) return bake_fail("more than 2^32 blocks of ground");
    int rc = open_crew(&c, tiles, workers);
    bake_jobs jobs = { "blocks", (uint32_t)blocks, (int)workers, &c, make_block, take_block };
    if (!rc) rc = bake_jobs_run(&jobs);
    close_crew(&c, workers);
    return rc;
}

double bake_tiles_bytes(const ff_terrain_info *info, uint32_t block_log2, uint32_t jobs)
{
    uint32_t log2 = info->tile_log2 < block_log2 ? info->tile_log2 : block_log2;
    double block = (double)(1u << log2),
           top = (double)(1u << (info->tile_log2 - log2 + info->node_log2));
    return (9 * block * block + 4 * top * top) * bake_tiles_workers(info, block_log2, jobs);
}
