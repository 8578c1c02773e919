#include "ff_far_stage.h"

#include <stdlib.h>
#include <string.h>

#define WIDTH_MAX 4096

/* Leaves the memory. */
static void leave(ff_far_stage *stage)
{
    ff_pack_ground_close(&stage->ground);
    if (stage->device) c3d_close(stage->device);
    stage->device = NULL;
    stage->pixels = 0;
}

void ff_far_stage_close(ff_far_stage *stage)
{
    leave(stage);
    free(stage->memory);
    stage->memory = NULL;
    stage->bytes = 0;
}

static int open_device(ff_far_stage *stage, size_t rows)
{
    c3d_desc desc;
    ff_pack_ground_desc(stage->pack, NULL, &desc);
    size_t side = ((size_t)1 << stage->pack->header.info.texture_log2) + 2;
    desc.use_vertex_buffers = 0;
    desc.frame_format = C3D_RGBA8888;
    desc.width = WIDTH_MAX;
    desc.height = (uint16_t)rows;
    desc.texture_bytes = (uint32_t)(desc.texture_count * ((side * side * 4 + 511) / 256 * 256));
    size_t bytes = c3d_bytes(c3d_backend_soft(), &desc);
    if (bytes > stage->bytes) {
        free(stage->memory);
        stage->memory = malloc(bytes);
        stage->bytes = stage->memory ? bytes : 0;
        if (!stage->memory) return FF_ERR_MEMORY;
    }
    int rc = c3d_open(c3d_backend_soft(), &desc, stage->memory, stage->bytes, &stage->device);
    if (rc < 0) stage->device = NULL;
    return rc;
}

int ff_far_stage_open(ff_far_stage *stage, size_t pixels)
{
    size_t rows = (pixels + WIDTH_MAX - 1) / WIDTH_MAX;
    leave(stage);
    int rc = open_device(stage, rows);
    if (rc == FF_OK)
        rc = ff_pack_ground_open(&stage->ground, stage->pack, stage->device, &stage->stats);
    if (rc < 0)
        ff_far_stage_close(stage);
    else
        stage->pixels = rows * WIDTH_MAX;
    return rc;
}

int ff_far_stage_draw(ff_far_stage *stage, const ff_ground_look *look, int32_t *distance)
{
    if ((size_t)look->camera.width * look->camera.height > stage->pixels) return FF_ERR_MEMORY;
    ff_pack_ground_load(&stage->ground, look);
    ff_pack_ground_draw(&stage->ground, look);
    return c3d_read_depth(stage->device, distance);
}

const uint8_t *ff_far_stage_pixels(ff_far_stage *stage)
{
    enum c3d_texture_format format;
    return c3d_frame_pixels(stage->device, &format);
}
