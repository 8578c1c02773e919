/* A source: one who answers, a pack on this device or a server over a link, with all that is asked
 * of it. Keys in its queue and in its messages number the tiles of its own grounds; those of the
 * tree number all sources' (ff_source_key). All is the main thread's but for what the queue and the
 * stream guard themselves. */
#ifndef FF_SOURCE_H
#define FF_SOURCE_H

#include "ask/ff_refusals.h"
#include "source/ff_local.h"
#include "source/link/ff_stream.h"

/* One of its grounds, in the order of ff_intake.info. */
typedef struct ff_source_ground {
    uint32_t whole;           /* checksum of the pack that its own is a part of, or is */
    uint8_t number;           /* among the tree's */
    uint32_t first_tile;      /* there */
    int32_t south_west_wu[2]; /* the place of its first sample there */
} ff_source_ground;

typedef struct ff_source {
    const ff_pack *pack; /* or NULL: */
    sys_stream *io;
    ff_requests requests;
    ff_intake intake;
    ff_stream stream;
    ff_refusals refusals;
    uint8_t number; /* among the sources */
    uint8_t serves; /* its grounds are among the tree's */
    int8_t error;   /* why not: ff_client_source_state */
    uint8_t down;   /* its link is, as seen last */
    uint32_t lacks; /* FF_LACKS_, as its server told: not asked for */
    /* the server refused to answer for a view: things are asked for singly */
    uint8_t no_views;
    uint32_t losses_seen;
    ff_layers layers; /* over its grounds */
    uint8_t layer;    /* that is shown of them, FF_LAYER_NONE: none is */
    ff_source_ground ground[FF_WELCOME_GROUNDS];
} ff_source;

/* A key of the source's messages as one of the tree's. */
static inline ff_key ff_source_key(const ff_source *source, ff_key own)
{
    int i = ff_intake_ground(&source->intake, own);
    FF_ASSERT(i >= 0);
    return own + ((ff_key)source->ground[i].first_tile << FF_KEY_TILE_SHIFT) -
           ((ff_key)source->intake.info[i].first_tile << FF_KEY_TILE_SHIFT);
}
/* The number of the source's ground that has a key of the tree, or -1. */
static inline int ff_source_ground_of(const ff_source *source, ff_key key)
{
    for (int i = 0; source->serves && i < source->intake.ground_count; i++)
        if (ff_key_tile(key) - source->ground[i].first_tile <
            ff_shape_tiles(&source->intake.info[i]))
            return i;
    return -1;
}
/* Such a key as one of its messages. */
static inline ff_key ff_source_own_key(const ff_source *source, ff_key key)
{
    int i = ff_source_ground_of(source, key);
    FF_ASSERT(i >= 0);
    return key + ((ff_key)source->intake.info[i].first_tile << FF_KEY_TILE_SHIFT) -
           ((ff_key)source->ground[i].first_tile << FF_KEY_TILE_SHIFT);
}

#endif
