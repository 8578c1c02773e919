/* What a pack says of itself, into the metadata of rasters made from it. */
#ifndef BAKE_ABOUT_GDAL_H
#define BAKE_ABOUT_GDAL_H

#include "../../protocol/ff_pack.h"
#include "../bake/raster/bake_gdal.h"

/* Fills a data set's metadata, as farfield-bake reads it again: name, attribution, licence, date
 * and vertical_datum, and TIFF's own tags of those that have one. */
void bake_about_metadata(const ff_pack *pack, GDALDatasetH set);
#endif
