/* Does a far set pay, and which? The rule of FF_FAR_AUTO: from what the client knows of its ground,
 * its link and its motion alone.
 *
 * What far ground would be off by without sets is estimated from what is drawn now
 * (ff_estimate_far); while sets are drawn, far ground is drawn more coarsely than it would be
 * without: there the limit of triangles tells how much finer it could be. A set pays where
 *   - far ground shows, and
 *   - the skyline is off by 1.75 pixels of that estimate (of which a quarter is seen), or, on
 * ground without images, whose shading is as wrong as its shape, the mean error of far pixels times
 *     their share of the picture is 0.55 pixels or more.
 * So it does not over plains and the sea, nor where triangles abound. Which set: fins and paint
 * where they take no more than a quarter of the link; else a front that lies farther away (half as
 * many bytes for a front 1.4 times as far: fewer pixels, and a longer life), then half as many
 * texels along both axes, then fins alone; then nothing. A nearer front where there are no images
 * and it costs next to nothing, for who stays or walks; and where triangles are so short that near
 * ground is four times as coarse as was asked for, for a sixteenth of the link. Fins alone, too,
 * where hardly any far ground shows, or no paint is wanted. Who has chosen keeps to it while the
 * figures are about half as large: with sets, what ground would be without them is estimated too
 * low. */
#ifndef FF_FAR_RULE_H
#define FF_FAR_RULE_H

#include "../terrain/ff_estimate.h"

typedef struct ff_far_case {
    ff_far_ground ground; /* as drawn, by the usual front */
    uint32_t window;      /* pixels */
    uint16_t width;       /* of it */
    uint8_t coarse;       /* far ground is drawn so many times as coarsely as near ground, 1: not */
    uint8_t has_images, no_paint;
    uint32_t triangles, triangles_max; /* 0: no limit */
    int32_t asked_px_q8, ground_px_q8; /* pixels of error asked for, and in force for near ground */
    int32_t life_wu;                   /* of a set with the usual front */
    int64_t speed_wu_s;
    uint32_t link_bytes_s; /* what it is found to carry; 0: not known yet */
} ff_far_case;

/* What sets are asked for: enum ff_far_use; the front is 2^(rung/2) times as far as the usual one;
 * texels are 2^shift as wide. */
typedef struct ff_far_choice {
    uint8_t use;
    int8_t rung; /* -FF_FAR_NEARER to 2 */
    uint8_t shift;
} ff_far_choice;
/* 2^(rung/2), Q8 */
static inline uint32_t ff_far_times_q8(int rung)
{
    static const uint16_t times_q8[] = { 128, 181, 256, 362, 512 };
    return times_q8[rung + FF_FAR_NEARER];
}

/* `now`: what was chosen last. */
ff_far_choice ff_far_choose(const ff_far_case *of, const ff_far_choice *now);

#endif
