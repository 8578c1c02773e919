/* The ground, drawn by the soft back end: the same picture on every machine, and one that tells
 * distances. */
#ifndef FF_FAR_STAGE_H
#define FF_FAR_STAGE_H

#include "../ground/ff_pack_ground.h"

typedef struct ff_far_stage {
    const ff_pack *pack;
    void *memory;
    size_t bytes;  /* of memory */
    size_t pixels; /* of the largest picture; 0: not open */
    c3d_device *device;
    ff_pack_ground ground;
    ff_pack_ground_stats stats;
} ff_far_stage;

/* Begins anew, with nothing loaded: what is drawn must not depend on what was drawn before. Reading
 * it all again takes a tenth of the time that drawing takes. FF_OK or a negative error, with the
 * stage closed. */
int ff_far_stage_open(ff_far_stage *stage, size_t pixels);
void ff_far_stage_close(ff_far_stage *stage);

/* Loads and draws. `distance` has a value for each pixel: FF_ERR_MEMORY when there are too many. */
int ff_far_stage_draw(ff_far_stage *stage, const ff_ground_look *look, int32_t *distance);
/* The picture drawn last, RGBA8888. */
const uint8_t *ff_far_stage_pixels(ff_far_stage *stage);

#endif
