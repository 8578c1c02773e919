/* The integer-only back end of the Common 3D API, for devices without GPU and FPU. Callers use
 * c3d.h; this says what it does exactly.
 *
 * Conventions
 *   Pixels: a pixel is covered when its centre (x + 1/2, y + 1/2) lies inside a triangle; of
 *       centres on an edge those on a left or an
 *   upper edge belong to it (top-left rule). Edges are walked exactly, not to some precision: two
 *       triangles with a common edge share
 *   no pixel and leave none out, so every pixel of a closed surface is written once.
 *   Screen: vertices are rounded to 1/16 pixel. They may lie up to 4096 pixels from the principal
 *       point; what reaches further,
 *   and what crosses the near or far plane, is clipped in eye space first.
 *   Eye space: 32 bits in a unit of its own for each frame (2^k to a wu), so that the far plane
 *       lies below 2^28 units: 0.5 mm at
 *   100 km. A vertex is rotated from its exact place relative to the camera: meshes that share a
 *       vertex get the same pixel for it,
 *   whatever their origins.
 *   Depth: near/z, 30 fraction bits, 32 bits a pixel; the greater hides the smaller, of equals the
 *       later is drawn. It is linear over
 *   the screen. 0: nothing was drawn here, 1: a backdrop.
 *   Textures: bilinear, clamped to the edge, with 4-bit weights where a pixel takes its colour from
 *       the texture alone into RGB565,
 *   8-bit ones elsewhere. In RGB565 spans over which a texel is as wide as 4 (8) pixels every 4th
 *       (8th) pixel of the frame is sampled and
 *   those between are blended. Each texture is kept with a rim one texel wide, so that no pixel of
 *       a span needs a test;
 *   RGB565 in 32 bits a texel, its fields apart (soft_sample.h).
 *   Perspective: triangles up to 8 rows and 32 pixels, white and textured, over which depth changes
 *       by 1/8 at most, and others up to 128 over
 *   which linear interpolation is off by at most 1/4 texel (1/16 of the colours' difference), are
 *       interpolated linearly; so is a row of a
 *   larger one under a texture alone. All the rest is divided exactly every 8 to 64 pixels, by how
 *       fast depth changes: at one texel a
 *   pixel the error between is 1/4 texel, too.
 *   Triangles of any size in colours alone are linear, too, where that is off by 4/255 at most.
 *   Colours: fog and vertex colours are interpolated with 16 fraction bits and rounded to the
 *       frame's format.
 *   Backdrops drawn before everything else wait until the end of the frame and then fill, the last
 *       one first, what nothing has covered:
 *   the picture is the same and no pixel is painted twice. Their meshes are copied meanwhile.
 * The frame's format is C3D_RGB565 or C3D_RGBA8888 (c3d_desc.frame_format); c3d_frame_pixels gives
 * the finished picture.
 */
#ifndef C3D_SOFT_H
#define C3D_SOFT_H

#include "../c3d_backend.h"

#define C3D_SOFT_BACKDROPS         8 /* drawn later in one frame; further ones are drawn at once */
#define C3D_SOFT_BACKDROP_VERTICES 128 /* of all of them */

#endif
