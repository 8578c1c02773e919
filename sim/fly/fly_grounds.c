#include "fly_grounds.h"

#include <stdio.h>

#define PATH_SAMPLES_MAX (4097u * 4097u) /* 34 MB: the level of a ground that paths keep above */

static int fail(const char *what, const char *why)
{
    fprintf(stderr, "farfield-fly: %s: %s\n", what, why);
    return -1;
}

/* 1 when one of the first `count` packs is of the same ground, whole or a part of it. */
static int is_among(const ff_pack *pack, const ff_packs *packs, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (ff_terrain_same_ground(&packs->pack[i].header.info, ff_pack_whole(&packs->pack[i]),
                                   &pack->header.info, ff_pack_whole(pack)))
            return 1;
    return 0;
}

static int join_packs(fly_grounds *grounds, const fly_options *options, const ff_packs *served,
                      const ff_packs *locals)
{
    size_t count = 0;
    for (size_t i = 0; i < served->count; i++) grounds->path[count++] = options->pack[i];
    for (size_t i = 0; i < locals->count; i++) {
        if (is_among(&locals->pack[i], served, served->count) ||
            is_among(&locals->pack[i], locals, i))
            continue;
        if (count == FF_PACKS_MAX) return fail(options->local[i], "too many grounds");
        grounds->path[count++] = options->local[i];
    }
    if (ff_packs_open(&grounds->packs, grounds->path, count) == FF_OK) return 0;
    fprintf(stderr, "farfield-fly: %s\n", grounds->packs.why);
    return -1;
}

/* Reads ground `i` whole, from a file kept of it where there is to be one. */
static int read_truth(fly_grounds *grounds, size_t i, const ff_pack *pack, const char *path,
                      const char *cache)
{
    char kept[4096];
    const ff_terrain_info *info = &pack->header.info;
    double error_m = (double)info->hscale_q24 / (1 << 24) * info->max_error;
    if (cache && i > 0) {
        if (snprintf(kept, sizeof kept, "%s.%zu", cache, i + 1) >= (int)sizeof kept)
            return fail(cache, "path too long");
        cache = kept;
    }
    int rc = sim_ground_load_cached(&grounds->truth[i], pack, UINT64_MAX, cache);
    if (rc != FF_OK) return fail(path, ff_pack_error_text(pack, rc));
    if (error_m > grounds->truth_error_m) grounds->truth_error_m = error_m;
    return 0;
}

/* The same from another pack of the same samples, which is needed no longer once it is decoded. */
static int read_other_truth(fly_grounds *grounds, size_t i, const char *path, const char *cache)
{
    ff_packs other = { .count = 0 };
    const ff_terrain_info *info = &grounds->packs.pack[i].header.info;
    if (ff_packs_add(&other, path) != FF_OK) {
        fprintf(stderr, "farfield-fly: %s\n", other.why);
        return -1;
    }
    ff_terrain_info *own = &other.pack[0].header.info;
    const char *why = sim_ground_differs(info, own);
    own->west_wu = info->west_wu;
    own->south_wu = info->south_wu;
    if (why)
        fprintf(stderr, "farfield-fly: %s: no truth for %s: %s\n", path, grounds->path[i], why);
    int rc = why ? -1 : read_truth(grounds, i, &other.pack[0], path, cache);
    ff_packs_close(&other);
    return rc;
}

static int read_grounds(fly_grounds *grounds, const fly_options *options)
{
    for (size_t i = 0; i < grounds->packs.count; i++) {
        const ff_pack *pack = &grounds->packs.pack[i];
        int rc = sim_ground_load(&grounds->moderate[i], pack, PATH_SAMPLES_MAX);
        if (rc != FF_OK) return fail(grounds->path[i], ff_error_text(rc));
        if (i > 0) sim_ground_join(&grounds->moderate[0], &grounds->moderate[i]);
        if (!options->audit) continue;
        if (i < options->truths.count
                ? read_other_truth(grounds, i, options->truth[i], options->ground_cache)
                : read_truth(grounds, i, pack, grounds->path[i], options->ground_cache))
            return -1;
        if (i > 0) sim_ground_join(&grounds->truth[0], &grounds->truth[i]);
    }
    return 0;
}

int fly_grounds_open(fly_grounds *grounds, const fly_options *options, const ff_packs *served,
                     const ff_packs *locals)
{
    return join_packs(grounds, options, served, locals) || read_grounds(grounds, options) ? -1 : 0;
}

void fly_grounds_close(fly_grounds *grounds)
{
    for (size_t i = 0; i < FF_PACKS_MAX; i++) {
        sim_ground_free(&grounds->moderate[i]);
        sim_ground_free(&grounds->truth[i]);
    }
    ff_packs_close(&grounds->packs);
}
