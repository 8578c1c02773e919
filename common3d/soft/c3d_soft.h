/* The integer-only back end of the Common 3D API, for devices without GPU and FPU. Callers use
 * c3d.h; this says what it does exactly.
 *
 * Conventions
 *   Pixels: a pixel is covered when its centre (x + 1/2, y + 1/2) lies inside a triangle. A centre
 *       on an edge belongs to the triangle when that edge is a left or an upper one (top-left
 * rule). Edges are walked exactly, not to some precision: two triangles with a common edge share no
 *       pixel and leave none out, so every pixel of a closed surface is written once.
 *   Screen: vertices are rounded to 1/16 pixel. They may lie up to 4096 pixels from the principal
 *       point. Triangles that reach further, or cross the near or far plane, are clipped in eye
 *       space first.
 *   Eye space: 32 bits in a unit of its own for each frame (2^k to a wu), chosen so that the far
 *       plane lies below 2^28 units: 0.5 mm at 100 km. A vertex is rotated from its exact place
 *       relative to the camera: meshes that share a vertex get the same pixel for it, whatever
 * their origins. Depth: near/z with 30 fraction bits, 32 bits a pixel, linear over the screen. The
 * greater depth hides the smaller; of equal depths the later is drawn. 0 means that nothing was
 * drawn here, 1 that a backdrop was. Textures: bilinear, clamped to the edge. Weights have 4 bits
 * where a pixel takes its colour from the texture alone into RGB565, elsewhere 8 bits. In RGB565
 * spans where a texel is as wide as 4 (8) pixels, every 4th (8th) pixel of the frame is sampled and
 * the pixels between are blended. Each texture is kept with a rim one texel wide, so that no pixel
 * of a span needs a test; RGB565 is kept in 32 bits a texel, its fields apart (soft_sample.h).
 *   Perspective: three kinds of triangles are interpolated linearly: white textured triangles up to
 *       8 rows and 32 pixels over which depth changes by at most 1/8; others up to 128 pixels where
 *       that is off by at most 1/4 texel or 1/16 of the colours' difference; triangles of any size
 *       in colours alone where it is off by at most 4/255. So is a row of a larger triangle under a
 *       texture alone, where that is off by at most 1/4 texel. Everything else is divided exactly
 *       every 8 to 64 pixels, by how fast depth changes: at one texel a pixel, the error between
 *       two divisions is 1/4 texel, too.
 *   Thrown pictures (C3D_DRAW_PROJECTED): s and t are right within 1/4 texel (2048 texels a side,
 *       5 to 300 km away, a pixel as large as a texel). What is thrown over what was drawn before
 *       counts as nearer by 1/1024 of its distance and a little, because other ways of drawing
 *       round depths in theirs.
 *   Colours: fog and vertex colours are interpolated with 16 fraction bits and rounded to the
 *       frame's format.
 *   Backdrops: those drawn before everything else wait until the end of the frame, with copies of
 *       their meshes. Then they fill, the last one first, what nothing has covered: the picture is
 *       the same, and no pixel is painted twice.
 *   The frame's format is C3D_RGB565 or C3D_RGBA8888 (c3d_desc.frame_format); c3d_frame_pixels
 *       gives the finished picture.
 */
#ifndef C3D_SOFT_H
#define C3D_SOFT_H

#include "../c3d_backend.h"

#define C3D_SOFT_BACKDROPS         8   /* that wait in one frame; further ones are drawn at once */
#define C3D_SOFT_BACKDROP_VERTICES 128 /* of all backdrops that wait */

#endif
