#include "bake_view.h"

GDALDatasetH bake_view(GDALDatasetH set, char **words)
{
    words = CSLAddString(CSLAddString(words, "-of"), "VRT");
    GDALTranslateOptions *options = GDALTranslateOptionsNew(words, NULL);
    GDALDatasetH view = GDALTranslate("", set, options, NULL);
    GDALTranslateOptionsFree(options);
    CSLDestroy(words);
    return view;
}
