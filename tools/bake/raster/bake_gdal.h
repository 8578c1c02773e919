/* GDAL's C headers, spared from this project's stricter warnings. */
#ifndef BAKE_GDAL_H
#define BAKE_GDAL_H

#pragma GCC system_header

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <gdal.h>
#include <gdal_alg.h>
#include <gdal_utils.h>
#include <gdal_vrt.h>
#include <gdalwarper.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>

#endif
