/* A scene for the auditor: wide ground of known shape under a camera in its middle, what is drawn
 * of it, and what the auditor must say. */
#ifndef SCENE_FIXTURE_H
#define SCENE_FIXTURE_H

#include "../../sim/judge/sim_audit.h"

enum { SCENE_STEP_PX = 8, SCENE_SIDE = 9 };

typedef struct scene {
    uint8_t *bytes;
    ff_pack pack;
    sim_ground ground;
    sim_auditor *auditor;
    ff_drawn drawn[16];
    uint16_t heights[SCENE_SIDE * SCENE_SIDE];
    sim_audit_view view;
} scene;

/* 4 by 4 tiles of 8 cells of 512 m: 16 km of ground, `height` metres of sample (x, y); the camera
 * 200 m above z = 0 in its middle, level, looking north. */
void scene_make(scene *s, uint16_t (*height)(void *context, uint32_t x, uint32_t y));
/* All of it at z = 0. */
void scene_flat(scene *s);
/* The same, falling away from the viewer as steeply as a pack can say. */
void scene_round(scene *s);
void scene_free(scene *s);
/* Draws all tiles, level, so many metres high. */
void scene_draw(scene *s, uint16_t metres);
/* A panorama of all faces, taken `west_m` and `south_m` from where the viewer is. */
void scene_panorama(scene *s, unsigned face_size, int32_t west_m, int32_t south_m);
/* Where the terrain ends in the north, seen from above_m above its end: a level line, so far below
 * the middle of the picture. */
double scene_border_px(const scene *s, double above_m);

/* The usual pack, and its whole ground. */
void scene_usual_ground(uint8_t **bytes, ff_pack *pack, sim_ground *ground);
double scene_uniform(sys_random *random, double low, double high);
/* Equal to a millionth. */
void scene_assert_near(double a, double b);

#endif
