/* Is far ground cheaper as a panorama? The rule of FF_PANORAMA_AUTO: from what the client knows of
 * its ground, its link and its motion alone.
 *
 * Both ways are held to one error, that of the ground now drawn: pixels of error are a bound, and
 * ground stays within a quarter of them in 19 pixels of 20 (make front), and above 24 is taken as
 * 24: a set that may be worse stays while ground would get better. A set of faces stays
 * within it only where half its texels are smaller, and only for as long as the viewer moves less
 * than the rest of it allows (Hybrid eq. 6, 7). A panorama is worth it when
 *   - the limit of triangles makes ground half as coarse again as was asked for, or more;
 *   - the ground beyond the back plane is a third of the triangles drawn, or more;
 *   - ground is so coarse that a face's texels are fine enough;
 *   - the sets that the viewer then flies through take no more than a sixteenth of the link; once
 *     they are drawn, an eighth of it: in flight, ground beyond the back plane takes less than
 * that, as most of it is needed on arrival anyway. */
#ifndef FF_PANORAMA_AUTO_H
#define FF_PANORAMA_AUTO_H

#include <stdint.h>

typedef struct ff_panorama_case {
    int32_t focal_q8, half_width_q8; /* pixels */
    uint16_t face_size;
    int32_t front_wu;                  /* the back plane: where a panorama would begin */
    int32_t asked_px_q8, ground_px_q8; /* pixels of error asked for, and in force for ground */
    uint32_t triangles, far_triangles; /* drawn, and of them those beyond the back plane */
    int64_t speed_wu_s;
    uint32_t link_bytes_s; /* what it is found to carry; 0: unknown, or no link */
    uint32_t set_bytes;    /* of the faces in view */
} ff_panorama_case;

/* Pixels of error, Q8, that the viewer's motion may add to a set's; 0: ground is cheaper. `drawn`:
 * a panorama is drawn now, and triangles and ground_px_q8 are those from before. */
int32_t ff_panorama_worth_q8(const ff_panorama_case *of, int drawn);

#endif
