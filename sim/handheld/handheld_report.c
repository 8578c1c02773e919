#include "handheld.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct figure {
    const char *name;
    uint64_t value;
} figure;

#define FIGURES_MAX 64

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
#define TOLD(type, name, from, what) { #name, s.name },
#define KEPT(type, name, from, what)
#define PART(name, member) { #name, s.member },
        FF_CLIENT_FIGURES(TOLD, KEPT, PART)
#undef TOLD
#undef KEPT
#undef PART
            { "tree_err_px_q8", ff_client_error_px_q8(device->client) },
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

/* In JSON a hash is text: a number too large for its readers. */
static void print_figures(const handheld *device, int json)
{
    figure list[FIGURES_MAX];
    unsigned count = collect(device, list);
    for (unsigned i = 0; i < count; i++) {
        int hash = strstr(list[i].name, "_hash") != NULL;
        if (json)
            printf(hash ? "%s\"%s\": \"%016" PRIx64 "\"" : "%s\"%s\": %" PRIu64, i ? ",\n " : "{",
                   list[i].name, list[i].value);
        else
            printf(hash ? "%-22s %016" PRIx64 "\n" : "%-22s %" PRIu64 "\n", list[i].name,
                   list[i].value);
    }
}

static void print_pools(const handheld *device, int json)
{
    ff_pool_use pool[FF_POOLS_MAX];
    unsigned count = ff_client_pools(device->client, pool);
    for (unsigned i = 0; i < count; i++) {
        if (json)
            printf("%s\"%s\": {\"count\": %" PRIu32 ", \"bytes\": %zu, \"high\": %" PRIu32
                   ", \"inside\": %u}",
                   i ? ",\n  " : ",\n \"pools\": {", pool[i].name, pool[i].count, pool[i].bytes,
                   pool[i].high, pool[i].inside);
        else
            printf("%s%-*s %" PRIu32 " of %" PRIu32 " used at most, %zu bytes\n",
                   pool[i].inside ? "  in it " : "pool ", pool[i].inside ? 14 : 17, pool[i].name,
                   pool[i].high, pool[i].count, pool[i].bytes);
    }
    if (json) puts("}}");
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
    print_figures(device, device->options->json);
    print_pools(device, device->options->json);
    return device->options->fb_path ? write_picture(device) : 0;
}
