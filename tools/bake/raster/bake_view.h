/* Views of data sets. */
#ifndef BAKE_VIEW_H
#define BAKE_VIEW_H

#include "bake_gdal.h"

/* A view (VRT) that reads from `set`, as gdal_translate makes it with these words, which are taken
 * over. NULL: GDAL's error. */
GDALDatasetH bake_view(GDALDatasetH set, char **words);

#endif
