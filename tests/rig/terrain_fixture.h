/* Ground made up in memory, and a tree fed from it. The ground may have any size; nodes are encoded
 * when they are asked for, and delivered at once or over a bad link. */
#ifndef TERRAIN_FIXTURE_H
#define TERRAIN_FIXTURE_H

#include "../../client/terrain/ff_tree.h"

/* Height in steps of sample (x, y) from the south-west corner. */
typedef uint16_t (*fixture_height)(uint32_t x, uint32_t y);
uint16_t fixture_hills(uint32_t x, uint32_t y);
uint16_t fixture_flat(uint32_t x, uint32_t y);
uint16_t fixture_cliffs(uint32_t x, uint32_t y); /* 0 or 65535 */
uint16_t fixture_noise(uint32_t x, uint32_t y);
/* plain to the west of x = 96, hills to the east */
uint16_t fixture_half_flat(uint32_t x, uint32_t y);

typedef struct terrain_fixture {
    ff_terrain_info info;
    fixture_height height;
    enum ff_hidden hidden;      /* fixture_make: FETCHED */
    uint32_t leaf_level;        /* nodes of this level come as leaves; fixture_make: none */
    int (*is_stub)(ff_key key); /* nodes that come as stubs; NULL: none */
    ff_decoder *decoder;
    ff_tree *tree;
    void *tree_memory;
} terrain_fixture;

/* Steps of 1 m, samples every 10 m; the test may change fx->info before fixture_tree. */
void fixture_make(terrain_fixture *fx, unsigned node_log2, unsigned tile_log2, uint32_t tiles_x,
                  uint32_t tiles_y, fixture_height height);
/* The ground ends with this many samples, and its tiles are as many as hold them. */
void fixture_samples(terrain_fixture *fx, uint32_t samples_x, uint32_t samples_y);
/* (Re)makes the tree, and the decoder for fx->info. */
void fixture_tree(terrain_fixture *fx, uint32_t node_count, uint32_t wish_count);
void fixture_free(terrain_fixture *fx);
/* Both at once, for the ground of most tests: 3 x 2 tiles of 1280 m, hills, nodes of 8 cells, 5
 * levels. */
void fixture_usual(terrain_fixture *fx, uint32_t node_count);
ff_tree_stats fixture_stats(const terrain_fixture *fx);

/* What the fixture keeps of a node: the heights that any decoder has. */
void fixture_decoded(const terrain_fixture *fx, ff_key key, uint16_t *heights);
/* Encodes, decodes and delivers one wish; the tree's answer. */
int fixture_deliver(terrain_fixture *fx, ff_key key, int refinement);
int fixture_deliver_from(terrain_fixture *fx, ff_key key, int refinement, unsigned by);
/* Selects and delivers until the tree wishes for nothing more (or `rounds` are over), then selects;
 * number of deliveries. */
uint32_t fixture_settle(terrain_fixture *fx, const ff_view *view, const ff_quality *quality,
                        uint32_t rounds);
/* The same of one tree with several grounds; and which of them has a node. */
uint32_t fixture_settle_all(terrain_fixture *list, uint32_t count, const ff_view *view,
                            const ff_quality *quality, uint32_t rounds);
terrain_fixture *fixture_of(terrain_fixture *list, uint32_t count, ff_key key);

/* A link that loses, delays and reorders: it keeps wishes in a bag and takes them out at random. */
#define FIXTURE_BAG 64
typedef struct fixture_link {
    sys_random random;
    uint32_t loss_percent, per_frame;
    uint32_t count;
    ff_wish bag[FIXTURE_BAG];
} fixture_link;
void fixture_link_step(terrain_fixture *fx, fixture_link *link);

/* Fails the test when the cut or its drawn part is not whole, or the statistics disagree with the
 * cut. */
void fixture_assert_whole(terrain_fixture *fx);

/* ff_drawn.origin_wu of a node. */
void fixture_origin(const ff_terrain_info *info, ff_key key, int32_t origin_wu[3]);

/* A camera at (x, y, z) metres, degrees, 240 by 320, 60 degrees wide; and Hybrid's low quality. */
ff_view fixture_view(int32_t x_m, int32_t y_m, int32_t z_m, int32_t yaw_deg, int32_t pitch_deg);
/* The same, above_m over the ground (steps of 1 m, samples every 10 m). */
ff_view fixture_view_above(const terrain_fixture *fx, int32_t x_m, int32_t y_m, int32_t above_m,
                           int32_t yaw_deg, int32_t pitch_deg);
ff_quality fixture_quality(enum ff_measure measure);

#endif
