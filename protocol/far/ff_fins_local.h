/* Private to fins and to the tool that trains their table (SPEC.md, "Fins").
 *
 * Places of probabilities: what follows, and numbers of six sorts, some of them by what is known of
 * the numbers before. */
#ifndef FF_FINS_LOCAL_H
#define FF_FINS_LOCAL_H

#include "../trained/ff_range.h"
#include "ff_far.h"

#define FF_FINS_BITS 16u /* of a number, below its highest one, at most 15 */

enum ff_fins_place {
    FF_FINS_MORE,                             /* one more fin */
    FF_FINS_ON,                               /* by how many vertices the fin has: one more */
    FF_FINS_SIGN = FF_FINS_ON + 8,            /* by sort and the sign of the same before */
    FF_FINS_LENGTH = FF_FINS_SIGN + 3 * 5,    /* by cell: one more bit */
    FF_FINS_FIRST = FF_FINS_LENGTH + 32 * 16, /* by sort and length: the highest bit but one */
    FF_FINS_CONTEXTS = FF_FINS_FIRST + 6 * 16
};

extern const uint16_t ff_fins_learned[FF_FINS_CONTEXTS];

/* As ff_fins_encode, from other probabilities; `seen`: how often decisions were 0 and 1, or NULL.
 */
int ff_fins_put(const uint16_t one[FF_FINS_CONTEXTS], uint32_t (*seen)[2],
                const ff_fin_vertex *vertex, uint32_t count, uint8_t *out, size_t capacity);

#endif
