#include "ff_far_picture.h"

void ff_far_place_of(const ff_far_picture *picture, const ff_far_axis *axis, int32_t column,
                     int32_t row, ff_far_place *place)
{
    int64_t f = ff_far_distance_at(picture, column, row);
    place->forward = f;
    place->right = f * (column - ff_far_middle(picture)) / picture->focal;
    place->up = f * (picture->height - 2 * row - 1) / (2 * (int64_t)picture->focal);
    place->east = (f * axis->forward_q30[0] + place->right * axis->right_q30[0]) >> 30;
    place->north = (f * axis->forward_q30[1] + place->right * axis->right_q30[1]) >> 30;
}
