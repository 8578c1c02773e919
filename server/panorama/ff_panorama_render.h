/* Panorama renderer: far ground into one cube face, as a finished message (Hybrid,
 * section 6.2). Ground whose largest coordinate difference to the position is below front_wu (less
 * a margin of one eighth, so that the join overlaps) or above back_wu is left out; sky is not
 * drawn: columns say where ground is. Draws with client/ground over the pack.
 */
#ifndef FF_PANORAMA_RENDER_H
#define FF_PANORAMA_RENDER_H

#include "../../common3d/c3d.h"
#include "../../protocol/message/ff_message.h"
#include "../../protocol/ff_pack.h"
#include "../ground/ff_pack_ground.h"

typedef struct ff_panorama_renderer ff_panorama_renderer;

/* What a renderer has done since it was opened. */
typedef struct ff_panorama_render_stats {
    uint32_t faces;
    uint32_t empty_by_bounds; /* found empty from bounds of terrain or nodes, without drawing */
    uint32_t empty_drawn;     /* found empty in the picture */
    ff_pack_ground_stats ground;
    uint64_t bytes;
    int64_t time_us; /* by sys_time_us */
} ff_panorama_render_stats;

/* Opens its own surface and device; every rendering makes its context current and leaves it so. The
 * pack must outlive it. FF_OK or a negative error. */
int ff_panorama_renderer_open(const ff_pack *pack, const sys_surface_api *surface_api,
                              const struct c3d_backend *backend, ff_panorama_renderer **renderer);
void ff_panorama_renderer_close(ff_panorama_renderer *renderer);

/* Bytes of the message written to `out`, or a negative error. Ground is drawn as fine as an error
 * of one pixel of the face asks for. A face without far ground is found empty from the tree alone,
 * without drawing. */
int ff_panorama_render_face(ff_panorama_renderer *renderer, const ff_get_panorama *request,
                            uint8_t face, int last, uint8_t *out, size_t capacity);

void ff_panorama_renderer_get_stats(const ff_panorama_renderer *renderer,
                                    ff_panorama_render_stats *stats);

#endif
