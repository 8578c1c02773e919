#include "export_encoding.h"

#include <math.h>

const export_encoding export_encoding_terrarium = { "terrarium", 1.0 / 256, -32768 },
                      export_encoding_mapbox = { "mapbox", 0.1, -10000 };

int export_encoding_holds(const export_encoding *encoding, double low_m, double high_m)
{
    return low_m >= encoding->offset_m &&
           high_m <= encoding->offset_m + EXPORT_ENCODING_HIGHEST * encoding->step_m;
}

void export_encode(const export_encoding *encoding, double metres, uint8_t rgb[3])
{
    double number = nearbyint((metres - encoding->offset_m) / encoding->step_m);
    uint32_t whole = (uint32_t)fmin(fmax(number, 0), EXPORT_ENCODING_HIGHEST);
    rgb[0] = (uint8_t)(whole >> 16);
    rgb[1] = (uint8_t)(whole >> 8);
    rgb[2] = (uint8_t)whole;
}

double export_decode(const export_encoding *encoding, const uint8_t rgb[3])
{
    uint32_t number = (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2];
    return number * encoding->step_m + encoding->offset_m;
}
