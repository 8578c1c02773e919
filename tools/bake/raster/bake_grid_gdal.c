#include "bake_grid_gdal.h"

#include "../bake_say.h"

#include <stdio.h>

GDALDatasetH bake_grid_dataset(const bake_grid *grid, GDALDataType type, int band_count)
{
    char xml[3000];
    int used = snprintf(xml, sizeof xml, "<VRTDataset rasterXSize=\"%u\" rasterYSize=\"%u\">",
                        grid->width, grid->height);
    for (int band = 0; band < band_count; band++)
        used += snprintf(
            xml + used, sizeof xml - (size_t)used,
            "<VRTRasterBand dataType=\"%s\" band=\"%d\" subClass=\"VRTRawRasterBand\">"
            "<SourceFilename relativetoVRT=\"0\">/proc/self/fd/%d</SourceFilename><ImageOffset>%u</ImageOffset>"
            "<PixelOffset>%u</PixelOffset><LineOffset>%llu</LineOffset><ByteOrder>%s</ByteOrder></VRTRasterBand>",
            GDALGetDataTypeName(type), band + 1, grid->fd,
            (unsigned)band * (unsigned)GDALGetDataTypeSizeBytes(type), grid->cell_bytes,
            (unsigned long long)grid->cell_bytes * grid->width, CPL_IS_LSB ? "LSB" : "MSB");
    snprintf(xml + used, sizeof xml - (size_t)used, "</VRTDataset>");
    GDALDatasetH set = GDALOpen(xml, GA_ReadOnly);
    if (!set) bake_fail_gdal("cannot open a temporary grid");
    return set;
}
