/* Heights as colours of 8 bits a channel: Terrarium and Terrain-RGB (Mapbox). Pure functions. */
#ifndef EXPORT_ENCODING_H
#define EXPORT_ENCODING_H

#include <stdint.h>

/* metres = (red * 65536 + green * 256 + blue) * step_m + offset_m */
typedef struct export_encoding {
    const char *name; /* as metadata say it */
    double step_m, offset_m;
} export_encoding;

#define EXPORT_ENCODING_HIGHEST 0xffffff

extern const export_encoding export_encoding_terrarium, export_encoding_mapbox;

/* 1 when all heights between these can be told. */
int export_encoding_holds(const export_encoding *encoding, double low_m, double high_m);
/* The nearest that can be told: within step_m / 2. */
void export_encode(const export_encoding *encoding, double metres, uint8_t rgb[3]);
double export_decode(const export_encoding *encoding, const uint8_t rgb[3]);

#endif
