/* Renderer of far sets: one sector of what a point O sees of far ground, as a finished FAR message
 * (protocol/far/ff_far.h): fins and paint, as far as anybody in the region round O can see them.
 *
 * Always drawn by the soft back end (common3d/soft): in integers, so that every machine gives the
 * same bytes, without a surface or a GL, and with the distances that everything here needs. Ground
 * nearer to O than front_wu, less an eighth, is left out, as panoramas do: the join overlaps. */
#ifndef FF_FAR_RENDER_H
#define FF_FAR_RENDER_H

#include "../ground/ff_pack_ground.h"
#include "../../protocol/message/ff_message.h"
#include "../../protocol/picture/ff_paint.h"

typedef struct ff_far_renderer ff_far_renderer;

/* What a renderer has done since it was opened. */
typedef struct ff_far_render_stats {
    uint32_t sectors, sectors_empty;
    uint32_t vertices, fins;      /* of fins */
    uint32_t blocks;              /* of paint that are there */
    uint64_t texels, texels_seen; /* of paint: that show ground; that somebody can see */
    uint64_t bytes, fins_bytes, paint_bytes;
    ff_pack_ground_stats ground;
    int64_t time_us; /* by sys_time_us */
} ff_far_render_stats;

/* The pack must outlive it. FF_OK or a negative error. */
int ff_far_renderer_open(const ff_pack *pack, ff_far_renderer **renderer);
void ff_far_renderer_close(ff_far_renderer *renderer);

/* Who trains sees what sectors are made of, before it is coded. `paint`: NULL, there is none;
 * `needed`: 1 for texels of it that somebody sees. */
typedef struct ff_far_watch {
    void *context;
    void (*sector)(void *context, const ff_paint_source *paint, const uint8_t *needed,
                   const ff_fin_vertex *vertex, uint32_t count);
} ff_far_watch;
/* `watch` stays where it is. */
void ff_far_renderer_watch(ff_far_renderer *renderer, const ff_far_watch *watch);

/* Bytes of the message written to `out`, or a negative error. */
int ff_far_render_sector(ff_far_renderer *renderer, const ff_get_far *request, uint8_t sector,
                         int last, uint8_t *out, size_t capacity);

void ff_far_renderer_get_stats(const ff_far_renderer *renderer, ff_far_render_stats *stats);

#endif
