#include "grounds_fixture.h"

#include "../../sim/judge/sim_watertight.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

void grounds_add(grounds_fixture *g, const terrain_fixture *fx, int32_t west_wu, int32_t south_wu)
{
    terrain_fixture *to = &g->ground[g->count];
    *to = *fx;
    to->info.west_wu = west_wu;
    to->info.south_wu = south_wu;
    if (g->count) {
        const ff_terrain_info *last = &g->ground[g->count - 1].info;
        to->info.first_tile = last->first_tile + ff_shape_tiles(last);
    }
    g->count++;
}

void grounds_tree(grounds_fixture *g, uint32_t node_count, uint32_t wish_count)
{
    ff_tree_desc desc = { .info = g->ground[0].info,
                          .node_count = node_count,
                          .wish_count = wish_count,
                          .hidden = g->hidden,
                          .ground_max = g->count,
                          .source_max = g->source_max,
                          .seam_max = g->seam_max };
    size_t bytes = ff_tree_bytes(&desc);
    g->memory = malloc(bytes);
    g->tree = ff_tree_create(&desc, g->memory, bytes);
    assert_non_null(g->tree);
    for (uint32_t i = 0; i < g->count; i++) {
        terrain_fixture *fx = &g->ground[i];
        size_t decoder_bytes = ff_decoder_bytes(&fx->info);
        if (i > 0) assert_int_equal(ff_tree_add_ground(g->tree, &fx->info), i);
        fx->decoder = ff_decoder_create(&fx->info, malloc(decoder_bytes), decoder_bytes);
        fx->tree = g->tree;
    }
}

void grounds_free(grounds_fixture *g)
{
    for (uint32_t i = 0; i < g->count; i++) free(g->ground[i].decoder);
    free(g->memory);
    memset(g, 0, sizeof *g);
}

terrain_fixture *grounds_of(grounds_fixture *g, ff_key key)
{
    return fixture_of(g->ground, g->count, key);
}

uint32_t grounds_settle(grounds_fixture *g, const ff_view *view, const ff_quality *quality,
                        uint32_t rounds)
{
    return fixture_settle_all(g->ground, g->count, view, quality, rounds);
}

void grounds_assert_whole(grounds_fixture *g)
{
    const ff_drawn *list;
    char why[160] = "";
    uint32_t count = ff_tree_cut(g->tree, &list);
    if (!sim_watertight_check_tree(g->tree, 0, list, count, why, sizeof why)) fail_msg("%s", why);
    ff_tree_stats stats;
    ff_tree_get_stats(g->tree, &stats);
    count = ff_tree_in_view(g->tree, &list);
    if (!stats.seams_short && !sim_watertight_check_tree(g->tree, 1, list, count, why, sizeof why))
        fail_msg("in view: %s", why);
}
