/* From a pack back to a raster. */
#ifndef BAKE_EXPORT_H
#define BAKE_EXPORT_H

#include "bake_unpack.h"

/* Decodes the ground down to `level` (0 roots .. levels-1) and writes it, cropped to the source's
 * samples, as GeoTIFF, 16-bit PNG or raw little-endian 16 bit (top row north), by the ending of
 * `path`: .tif, .png, .r16. 0 or -1 (said). */
int bake_export(const bake_unpack *unpack, uint32_t level, const char *path);

#endif
