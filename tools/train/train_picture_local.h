/* Private to train_picture*.c. */
#ifndef TRAIN_PICTURE_LOCAL_H
#define TRAIN_PICTURE_LOCAL_H

#include "train_picture.h"

/* Of each level: bytes, and the mean square of what texels are off. */
typedef struct train_coded {
    double bytes[TRAIN_PICTURE_LEVELS], squares[TRAIN_PICTURE_LEVELS];
} train_coded;

/* 0 or -1 (said). */
int train_pictures_code(const train_pictures *pictures, const ff_picture_tables *tables,
                        unsigned at_quality, train_coded *coded);

/* Learning, for any pictures: what is seen goes to the sums, weights and then probabilities come of
 * them. */
typedef struct train_learner {
    const ff_picture_tables *tables;
    train_picture_sums *sums;
} train_learner;
ff_picture_eye train_picture_eye(train_learner *learner);
void train_picture_begin(ff_picture_tables *tables);
void train_picture_weights(train_picture_sums *sums, ff_picture_tables *tables);
void train_picture_decisions(const train_picture_sums *sums, ff_picture_tables *tables);

#endif
