#include "view_blit.h"

#include <stdlib.h>
#include <string.h>

static int power_of_two(int least)
{
    int power = 1;
    while (power < least) power *= 2;
    return power;
}

int view_blit_open(view_blit *blit, const struct c3d_backend *backend,
                   const sys_surface_api *surface_api, int width, int height)
{
    const c3d_desc desc = { .surface_api = surface_api,
                            .mesh_count = 1,
                            .strip_count = 1,
                            .texture_count = 1,
                            .mesh_vertices_max = 4,
                            .strip_indices_max = 4 };
    size_t bytes = c3d_bytes(backend, &desc);
    *blit = (view_blit){ .width = width,
                         .height = height,
                         .texture_width = power_of_two(width),
                         .texture_height = power_of_two(height),
                         .window_width = width,
                         .window_height = height };
    blit->memory = malloc(bytes);
    blit->rgb = malloc((size_t)width * (size_t)height * 3);
    blit->rgba = calloc((size_t)blit->texture_width * (size_t)blit->texture_height, 4);
    int rc = blit->memory && blit->rgb && blit->rgba
                 ? c3d_open(backend, &desc, blit->memory, bytes, &blit->device)
                 : FF_ERR_MEMORY;
    if (rc < 0) {
        blit->device = NULL;
        view_blit_close(blit);
    }
    return rc;
}

void view_blit_close(view_blit *blit)
{
    if (blit->device) c3d_close(blit->device);
    free(blit->memory);
    free(blit->rgb);
    free(blit->rgba);
    memset(blit, 0, sizeof *blit);
}

static void widen_rows(view_blit *blit)
{
    for (int y = 0; y < blit->height; y++) {
        const uint8_t *in = blit->rgb + (size_t)y * (size_t)blit->width * 3;
        uint8_t *out = blit->rgba + (size_t)y * (size_t)blit->texture_width * 4;
        for (int x = 0; x < blit->width; x++, in += 3, out += 4) {
            memcpy(out, in, 3);
            out[3] = 255;
        }
    }
}

int view_blit_show(view_blit *blit, c3d_device *device)
{
    c3d_frame frame = { .camera = { .focal_q8 = 256,
                                    .near_wu = 1,
                                    .far_wu = 256,
                                    .width = (uint16_t)blit->window_width,
                                    .height = (uint16_t)blit->window_height } };
    int rc = c3d_read_rgb(device, blit->rgb);
    if (rc < 0) return rc;
    widen_rows(blit);
    c3d_texture texture = c3d_texture_make(blit->device, C3D_RGBA8888,
                                           (uint32_t)blit->texture_width,
                                           (uint32_t)blit->texture_height, blit->rgba);
    c3d_begin(blit->device, &frame);
    c3d_overlay(blit->device, texture, 0, 0, blit->texture_width * blit->window_width / blit->width,
                blit->texture_height * blit->window_height / blit->height);
    c3d_end(blit->device);
    c3d_texture_free(blit->device, texture);
    return FF_OK;
}
