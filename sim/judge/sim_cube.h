/* The cube round O on whose faces a panorama is drawn: where a direction meets it, and which
 * direction a place on it lies in, in double precision. As server/panorama/ff_face_view.h has it:
 * NORTH, EAST, SOUTH and WEST look level, the top of UP's image lies in the south, that of DOWN's
 * in the north. */
#ifndef SIM_CUBE_H
#define SIM_CUBE_H

#include "../../protocol/message/ff_message.h"

typedef struct sim_cube_place {
    enum ff_face_name face;
    /* texels from the left and from the top of the face's whole image, 0..size; texel (c, r) has
     * its middle at (c + 0.5, r + 0.5) */
    double column, row;
    double reach; /* how far the direction leads along the face's own axis */
} sim_cube_place;

/* `size`: texels of a face each way. */
void sim_cube_meet(const double direction[3], unsigned size, sim_cube_place *place);
/* The direction of a place; it leads 1 along the face's own axis. */
void sim_cube_direction(const sim_cube_place *place, unsigned size, double direction[3]);

#endif
