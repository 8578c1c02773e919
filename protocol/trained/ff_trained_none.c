/* Stands in for codec trained in builds without it. */
#include "ff_trained.h"

const uint8_t ff_trained_built = 0;

size_t ff_codec_room(const ff_terrain_info *info) { return (void)info, 0; }

int ff_trained_decode(const ff_decoder *dec, ff_payload *in, const ff_contents *contents,
                      ff_residuals *out)
{
    (void)dec, (void)in, (void)contents, (void)out;
    return FF_ERR_UNSUPPORTED;
}

void ff_trained_predict(const ff_terrain_info *info, ff_cells cells, unsigned way,
                        const uint16_t *parent, uint16_t *grid, void *room, ff_sample_fn sample,
                        void *context)
{
    ff_interpolate(info, cells, way, parent, grid, room, sample, context);
}

int ff_trained_without_sides(const ff_terrain_info *info, const uint8_t *payload, size_t bytes,
                             unsigned sides, uint8_t *out)
{
    (void)info, (void)payload, (void)bytes, (void)sides, (void)out;
    return 0;
}

int ff_trained_read_marks(const ff_terrain_info *info, int root, const uint8_t *payload,
                          size_t bytes, ff_residuals *out)
{
    (void)info, (void)root, (void)payload, (void)bytes, (void)out;
    return FF_ERR_UNSUPPORTED;
}

int ff_trained_mark_stubs(const ff_terrain_info *info, int root, const uint8_t *payload,
                          size_t bytes, uint8_t stub, uint8_t *out)
{
    (void)info, (void)root, (void)payload, (void)bytes, (void)stub, (void)out;
    return FF_ERR_UNSUPPORTED;
}

int ff_trained_reconstruct(const ff_terrain_info *info, const uint16_t *parent,
                           const ff_residuals *res, uint16_t *heights, void *room)
{
    (void)info, (void)parent, (void)res, (void)heights, (void)room;
    return FF_ERR_UNSUPPORTED;
}
