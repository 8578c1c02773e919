#include "bake_about_gdal.h"

#include "../bake/raster/bake_about.h"

#define TEXT_ROOM 4096

FF_STATIC_ASSERT(TEXT_ROOM >= FF_ABOUT_BYTES_MAX);

void bake_about_metadata(const ff_pack *pack, GDALDatasetH set)
{
    static const char *const item[][2] = {
        [FF_ABOUT_NAME] = { "name", "TIFFTAG_IMAGEDESCRIPTION" },
        [FF_ABOUT_ATTRIBUTION] = { "attribution", "TIFFTAG_COPYRIGHT" },
        [FF_ABOUT_LICENCE] = { "licence" },
        [FF_ABOUT_DATE] = { "date" },
        [FF_ABOUT_VERTICAL] = { "vertical_datum" },
    };
    char text[TEXT_ROOM];
    ff_list about;
    if (ff_pack_about(pack, &about) != FF_OK) return;
    for (unsigned entry = FF_ABOUT_NAME; entry <= FF_ABOUT_VERTICAL; entry++) {
        bake_about_text(about, (enum ff_about_entry)entry, text, sizeof text);
        for (int i = 0; *text && i < 2 && item[entry][i]; i++)
            GDALSetMetadataItem(set, item[entry][i], text, NULL);
    }
}
