#include "handheld.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct figure {
    const char *name;
    uint64_t value;
} figure;

#define FIGURES_MAX 48

/* Where the back end has the finished frame, for counters of memory accesses; NULL: no picture. */
static const void *pixels_of(const handheld *device, uint64_t *bytes)
{
    c3d_device *c3d = ff_client_device(device->client);
    enum c3d_texture_format format;
    const void *pixels = c3d ? c3d_frame_pixels(c3d, &format) : NULL;
    if (pixels) *bytes = (uint64_t)device->width * device->height * (format == C3D_RGB565 ? 2 : 4);
    return pixels;
}

static unsigned collect(const handheld *device, figure *list)
{
    ff_client_stats s;
    ff_client_get_stats(device->client, &s);
    const handheld_totals *t = &device->totals;
    uint64_t pixels_bytes = 0;
    const void *pixels = pixels_of(device, &pixels_bytes);
    const figure all[] = {
        { "frames", t->frames },
        { "frames_drawn", t->drawn },
        { "triangles_mean", t->drawn ? t->triangles / t->drawn : 0 },
        { "triangles_max", t->triangles_max },
        { "triangles_submitted_mean", t->drawn ? t->submitted / t->drawn : 0 },
        { "nodes_held", s.tree.nodes_held },
        { "nodes_high", s.tree.nodes_high },
        { "nodes_capacity", s.tree.nodes_capacity },
        { "pool_full", s.tree.pool_full },
        { "orphans", s.tree.orphans },
        { "meshes_high", s.c3d.mesh_high },
        { "strips_high", s.c3d.strip_high },
        { "device_textures_high", s.c3d.texture_high },
        { "textures_held", s.textures_held },
        { "textures_high", s.textures_high },
        { "textures_full", s.textures_full },
        { "panorama_requests", s.panorama_requests },
        { "panorama_faces", s.panorama_faces },
        { "panorama_faces_empty", s.panorama_faces_empty },
        { "panorama_bytes", s.panorama_bytes },
        { "requests_sent", s.requests_sent },
        { "requests_done", s.requests_done },
        { "requests_failed", s.requests_failed },
        { "in_flight_high", s.in_flight_high },
        { "queued_high", s.queued_high },
        { "protocol_errors", s.protocol_errors },
        { "bytes_down", s.bytes_down },
        { "bytes_up", s.bytes_up },
        { "share_percent", s.balance.share_percent },
        { "fidelity_percent", s.balance.fidelity_percent },
        { "balance_moves", s.balance.moves },
        { "tree_err_px_q8", s.tree.error_px_q8 },
        { "memory_used", s.memory_used },
        { "memory_bytes", s.memory_bytes },
        { "mapping_at", (uint64_t)(uintptr_t)device->mapping.bytes },
        { "mapping_bytes", device->mapping.size },
        { "pixels_at", (uint64_t)(uintptr_t)pixels },
        { "pixels_bytes", pixels_bytes },
        { "pictures_hash", t->pictures_hash },
        { "geometry_hash", ff_client_geometry_hash(device->client) },
        { "request_hash", ff_client_request_hash(device->client) },
    };
    memcpy(list, all, sizeof all);
    return sizeof all / sizeof all[0];
}

static void print(const handheld *device)
{
    figure list[FIGURES_MAX];
    unsigned count = collect(device, list);
    int json = device->options->json;
    for (unsigned i = 0; i < count; i++) {
        /* a number too large for JSON readers */
        int hash = strstr(list[i].name, "_hash") != NULL;
        if (json)
            printf(hash ? "%s\"%s\": \"%016" PRIx64 "\"" : "%s\"%s\": %" PRIu64, i ? ",\n " : "{",
                   list[i].name, list[i].value);
        else
            printf(hash ? "%-22s %016" PRIx64 "\n" : "%-22s %" PRIu64 "\n", list[i].name,
                   list[i].value);
    }
    if (json) puts("}");
}

static int write_picture(handheld *device)
{
    size_t count = (size_t)device->width * device->height * 3;
    c3d_device *c3d = ff_client_device(device->client);
    char head[32];
    int head_bytes = snprintf(head, sizeof head, "P6\n%u %u\n255\n", device->width, device->height);
    uint8_t *ppm = malloc((size_t)head_bytes + count);
    int rc = ppm && c3d ? FF_OK : ppm ? FF_ERR_UNSUPPORTED : FF_ERR_MEMORY;
    if (rc == FF_OK) {
        memcpy(ppm, head, (size_t)head_bytes);
        rc = c3d_read_rgb(c3d, ppm + head_bytes);
    }
    if (rc == FF_OK) rc = sys_write_file(device->options->fb_path, ppm, (size_t)head_bytes + count);
    free(ppm);
    if (rc == FF_OK) return 0;
    fprintf(stderr, "farfield-handheld: %s: %s\n", device->options->fb_path, ff_error_text(rc));
    return -1;
}

int handheld_report(handheld *device)
{
    print(device);
    return device->options->fb_path ? write_picture(device) : 0;
}
