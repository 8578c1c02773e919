/* What an export says of itself: whose ground it is, and how far it may be off. The one place where
 * that comes from, for rasters and for map tiles. */
#ifndef EXPORT_ABOUT_H
#define EXPORT_ABOUT_H

#include "export_ground.h"

#define EXPORT_NAME_BYTES 256
#define EXPORT_TEXT_BYTES 512

typedef struct export_about {
    char name[EXPORT_NAME_BYTES];
    char attribution[EXPORT_TEXT_BYTES]; /* "": the pack tells none */
    char error[EXPORT_TEXT_BYTES];       /* in words; "" of images */
    double error_m;                      /* the bound that the words begin with */
} export_about;

/* Of heights as they are in the pack. The name is the pack's file name. */
void export_about_ground(const export_ground *ground, export_about *about);
/* Adds words to what is said of the error. */
void export_about_add(export_about *about, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* As metadata of a raster. */
void export_about_tag(const export_about *about, GDALDatasetH set);

#endif
