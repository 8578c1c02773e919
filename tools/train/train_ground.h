/* Ground to train on: a pack's finest level as one grid, and how it is refined from a root down. */
#ifndef TRAIN_GROUND_H
#define TRAIN_GROUND_H

#include "train_fit.h"

typedef struct train_ground {
    const char *path;
    uint32_t width, height;
    double step_m; /* metres a height step */
    uint32_t max_error;
    uint16_t *heights; /* south to north */
} train_ground;

/* 0 or -1 (said). */
int train_ground_open(train_ground *ground, const char *path);
/* The same ground in FINER times as fine steps, what lies between the coarse ones by chance: what
 * an error of many steps does is learned of it. 0 or -1 (said). */
int train_ground_refine(train_ground *finer, const train_ground *ground);
void train_ground_close(train_ground *ground);

/* Who sees every point that is made, and every payload. */
typedef struct train_eye {
    void *context;
    void (*point)(void *context, const train_point *point);
    void (*payload)(void *context, size_t bytes); /* NULL: none are made */
} train_eye;

/* Which set of weights a payload is made by: the fine levels' by the first, until there is
 * something to choose from; then as the encoder chooses. */
enum train_choice { TRAIN_BY_LEVEL, TRAIN_AS_ENCODER };

/* Makes all tiles that lie wholly inside the ground, with nodes of 2^node_log2 cells and this error
 * at most, from what was decoded before, as the baker does. Samples of them: 0, out of memory. */
uint64_t train_ground_make(const train_ground *ground, const ff_trained *by,
                           enum train_choice choice, unsigned node_log2, uint32_t max_error,
                           const train_eye *eye);

#endif
