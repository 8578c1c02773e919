/* Layers of images over one ground (protocol/SPEC.md, "Layers"): what they are called, and how deep
 * each one is. All of a pack's layers have images of one size and one coding; a layer is named in
 * messages and in sections by its number, the first one's is 0. */
#ifndef FF_LAYERS_H
#define FF_LAYERS_H

#include "ff_bytes.h"

#define FF_LAYERS_MAX       8
#define FF_LAYER_NONE       FF_LAYERS_MAX /* where a layer is named: none of them */
#define FF_LAYER_NAME_MAX   31            /* bytes */
#define FF_LAYER_GROUNDS    7             /* of one server */
#define FF_LAYERS_BYTES_MAX (FF_LAYERS_MAX * (2 + FF_LAYER_NAME_MAX + FF_LAYER_GROUNDS))
#define FF_LAYERS_NAMES_MAX (FF_LAYERS_MAX * (2 + FF_LAYER_NAME_MAX)) /* bytes of names alone */

typedef struct ff_layers {
    uint8_t count;                                   /* 0: no images */
    char name[FF_LAYERS_MAX][FF_LAYER_NAME_MAX + 1]; /* only the first one's may be "" */
    uint8_t levels[FF_LAYERS_MAX][FF_LAYER_GROUNDS]; /* over each ground; 0: there is none */
} ff_layers;

/* 1 when a layer may be called so; only the first one may be called "". */
int ff_layer_name_ok(const char *name);
/* A row for each layer: its name, then its levels over so many grounds; what more a row has is
 * passed over. FF_OK, TRUNCATED or RANGE; `layers` may be NULL. */
int ff_layers_read(const uint8_t *bytes, uint32_t byte_count, unsigned grounds, ff_layers *layers);
void ff_layers_write(ff_writer *out, const ff_layers *layers, unsigned grounds);
/* The number of a layer; "" is the first one whatever it is called. FF_ERR_NOT_FOUND. */
int ff_layers_find(const ff_layers *layers, const char *name);

#endif
