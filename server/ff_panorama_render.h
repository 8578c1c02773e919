/* Panorama renderer: far ground into one cube face, as a finished FF_MSG_FACE message (Hybrid, section 6.2).
 * Ground whose largest coordinate difference to the position is below front_wu (less a margin of one eighth, so that the join
 * overlaps) or above back_wu is left out; sky is not drawn: columns say where ground is. Draws with client/terrain over the pack.
 */
#ifndef FF_PANORAMA_RENDER_H
#define FF_PANORAMA_RENDER_H

#include "../common3d/c3d.h"
#include "../protocol/ff_message.h"
#include "../protocol/ff_pack.h"

typedef struct ff_panorama_renderer ff_panorama_renderer;

/* Opens its own surface and device. FF_OK or a negative error. */
int ff_panorama_renderer_open(const ff_pack *pack, const sys_surface_api *surface_api, const struct c3d_backend *backend,
                              ff_panorama_renderer **renderer);
void ff_panorama_renderer_close(ff_panorama_renderer *renderer);

/* Bytes of the message written to `out`, or a negative error. error_px 1 of the face decides the level of detail. A face without far
 * ground is found empty from the tree alone, without drawing. */
int ff_panorama_render_face(ff_panorama_renderer *renderer, const ff_get_panorama *request, uint8_t face, int last, uint8_t *out,
                            size_t capacity);

#endif
