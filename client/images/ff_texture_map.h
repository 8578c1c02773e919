/* How an image covers a node: one rule for the client and the server's renderer, so that near and
 * far ground agree in colour.
 *
 * A texture of T = 2^texture_log2 texels a side spans the node of its own key edge to edge: texel i
 * lies at i/(T-1) of the edge, so that neighbouring textures share their rim texels and filtering
 * needs no neighbours. Its JPEG is stored north up.
 */
#ifndef FF_TEXTURE_MAP_H
#define FF_TEXTURE_MAP_H

#include "../../protocol/ff_terrain.h"

#include <stddef.h>

/* Coordinates of c3d_draw for `node`, whose grid has columns and rows 0..2^k, under the texture of
 * `texture`: itself, any ancestor, or a descendant on whole cells, beyond which they mean nothing.
 */
void ff_texture_map(const ff_terrain_info *info, ff_key node, ff_key texture, int32_t scale_q16[2],
                    int32_t offset_q16[2]);

/* A decoded JPEG (RGB888, T by T, north row first) as C3D_RGB565 pixels, south row first. */
void ff_texture_texels(const ff_terrain_info *info, const uint8_t *rgb, uint16_t *texels);

#endif
