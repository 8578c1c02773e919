/* Several grounds made up in memory, and one tree that holds them all. */
#ifndef GROUNDS_FIXTURE_H
#define GROUNDS_FIXTURE_H

#include "terrain_fixture.h"

typedef struct grounds_fixture {
    terrain_fixture ground[FF_GROUNDS_MAX]; /* each has the same tree */
    uint32_t count, source_max, seam_max;   /* the last two: 0, or set before the tree is made */
    enum ff_hidden hidden;                  /* alike */
    ff_tree *tree;
    void *memory;
} grounds_fixture;

/* Adds ground like `fx` (fixture_make), its south-west sample at a place; its tiles follow those of
 * the ones before. Before the tree is made. */
void grounds_add(grounds_fixture *g, const terrain_fixture *fx, int32_t west_wu, int32_t south_wu);
void grounds_tree(grounds_fixture *g, uint32_t node_count, uint32_t wish_count);
void grounds_free(grounds_fixture *g);

terrain_fixture *grounds_of(grounds_fixture *g, ff_key key);
/* As the functions of terrain_fixture.h do. */
uint32_t grounds_settle(grounds_fixture *g, const ff_view *view, const ff_quality *quality,
                        uint32_t rounds);
/* Each ground's part of the cut is whole by itself, and that in view as its seams lower it, where
 * they had room. */
void grounds_assert_whole(grounds_fixture *g);

#endif
