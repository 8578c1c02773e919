#include "fly_world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATH_SAMPLES_MAX (4097u * 4097u) /* 34 MB: the level of ground that paths keep above */

static int fail_with(const char *what, const char *why)
{
    fprintf(stderr, "farfield-fly: %s: %s\n", what, why);
    return -1;
}

static int fail_text(const char *text)
{
    fprintf(stderr, "farfield-fly: %s\n", text);
    return -1;
}

static int fail(const char *what, int rc) { return fail_with(what, ff_error_text(rc)); }

/* The ground that the audit judges by: the pack's, or that of a pack which is needed no longer once
 * it is decoded. */
static int open_truth(fly_world *world)
{
    const fly_options *options = world->options;
    sys_mapping mapping = { 0 };
    ff_pack other = { .refusal = "" };
    const ff_pack *pack = world->pack;
    int rc = FF_OK;
    if (options->truth_path) {
        pack = &other;
        rc = sys_map_file(options->truth_path, &mapping);
        if (rc != FF_OK) return fail(options->truth_path, rc);
        rc = ff_pack_open(&other, mapping.bytes, mapping.size);
    }
    const ff_terrain_info *info = &pack->header.info;
    const char *why = rc == FF_OK ? sim_ground_differs(&world->pack->header.info, info) : NULL;
    if (rc == FF_OK && !why)
        rc = sim_ground_load_cached(&world->true_ground, pack, UINT64_MAX, options->ground_cache);
    if (rc == FF_OK) world->truth_error_m = (double)info->hscale_q24 / (1 << 24) * info->max_error;
    if (mapping.bytes) sys_unmap_file(&mapping);
    if (why)
        fprintf(stderr, "farfield-fly: %s: no truth for %s: %s\n", options->truth_path,
                options->pack_path, why);
    if (rc != FF_OK)
        return fail_with(options->truth_path ? options->truth_path : options->pack_path,
                         ff_pack_error_text(pack, rc));
    return why ? -1 : 0;
}

static int open_ground(fly_world *world)
{
    const fly_options *options = world->options;
    int rc = ff_packs_open(&world->packs, options->pack, options->packs.count);
    if (rc != FF_OK) return fail_text(world->packs.why);
    world->pack = &world->packs.pack[0];
    for (size_t i = 0; i < options->locals.count; i++) {
        if (ff_packs_add(&world->locals, options->local[i]) != FF_OK)
            return fail_text(world->locals.why);
        world->more[i].pack = &world->locals.pack[i];
    }
    rc = sim_ground_load(&world->path_ground, world->pack, PATH_SAMPLES_MAX);
    if (rc != FF_OK) return fail(options->pack_path, rc);
    const ff_terrain_info *info = &world->pack->header.info;
    fly_path_init(&world->path, options, info, &world->path_ground);
    if (options->audit) {
        if (open_truth(world)) return -1;
        world->auditor = sim_auditor_create(&world->true_ground, info, options->audit_step_px);
        if (!world->auditor) return fail("auditor", FF_ERR_MEMORY);
    }
    return 0;
}

static int open_link(fly_world *world)
{
    const fly_options *options = world->options;
    if (options->server) {
        int rc = sys_tcp_client(&world->tcp, options->server, &world->stream);
        return rc == FF_OK ? 0 : fail(options->server, rc);
    }
    world->link = sim_link_create(&options->link, options->seed);
    if (!world->link)
        return fail("link", options->link.way[SIM_DOWN].trace || options->link.way[SIM_UP].trace
                                ? FF_ERR_FORMAT
                                : FF_ERR_MEMORY);
    sim_stream_client(&world->client_end, world->link, &world->now_us, &world->stream);
    world->relevance = sim_relevance_create(&world->stream, &world->pack->header.info,
                                            &world->now_us);
    if (!world->relevance) return fail("relevance", FF_ERR_MEMORY);
    int rc = sim_server_init(&world->server, world->pack, world->link, &world->now_us);
    return rc == FF_OK ? 0 : fail("server", rc);
}

/* Opens the tape: from here on the stream records. */
static int open_tape(fly_world *world)
{
    const fly_options *options = world->options;
    sim_tape_head head = { .memory_bytes = (uint32_t)options->memory_bytes,
                           .width = options->size.width,
                           .height = options->size.height,
                           .quality = options->quality,
                           .panorama = options->panorama,
                           .hidden = (enum ff_hidden)options->hidden,
                           .no_views = !options->views };
    int rc = options->tape_path
                 ? sim_tape_record(&world->tape, options->tape_path, &head, &world->stream)
                 : FF_OK;
    return rc == FF_OK ? 0 : fail(options->tape_path, rc);
}

static int is_soft(enum fly_backend backend)
{
    return backend == FLY_SOFT || backend == FLY_SOFT_565;
}

static const struct c3d_backend *backend_of(enum fly_backend backend)
{
    if (backend == FLY_NONE) return NULL;
    return is_soft(backend)       ? c3d_backend_soft()
           : backend == FLY_GLES1 ? c3d_backend_gles1()
                                  : c3d_backend_gl();
}

static int open_reference(fly_world *world)
{
    const fly_options *options = world->options;
    if (!options->reference_dir && !options->diff) return 0;
    int rc = fly_reference_open(&world->reference, world->pack, options->size.width,
                                options->size.height);
    return rc == FF_OK ? 0 : fail("reference", rc);
}

static int open_surface(fly_world *world)
{
    const fly_options *options = world->options;
    sys_surface_desc desc = { "farfield-fly", options->size.width, options->size.height,
                              SYS_GL_DESKTOP };
    if (options->backend == FLY_NONE) return 0;
    world->surface_api = sys_surface_osmesa();
    if (options->backend == FLY_GLES1) {
        world->surface_api = sys_surface_egl();
        desc.gl = SYS_GL_ES1;
    } else if (is_soft(options->backend)) {
        world->surface_api = sys_surface_memory();
        desc.gl = SYS_GL_NONE;
    }
    int rc = world->surface_api ? world->surface_api->open(&desc, &world->surface)
                                : FF_ERR_UNSUPPORTED;
    if (rc == FF_OK) return 0;
    world->surface = NULL;
    return fail(fly_backend_name(options->backend), rc);
}

static int asked_for_reserve(void *client, uint16_t id)
{
    return ff_client_asked_for_reserve(client, id);
}

static int open_client(fly_world *world)
{
    const fly_options *options = world->options;
    world->memory = malloc(options->memory_bytes);
    if (!world->memory) return fail("client", FF_ERR_MEMORY);
    ff_client_desc desc = { .memory = world->memory,
                            .memory_bytes = options->memory_bytes,
                            .stream = &world->stream,
                            .more = world->more,
                            .more_count = (unsigned)options->locals.count,
                            .surface_api = world->surface_api,
                            .width = options->size.width,
                            .height = options->size.height,
                            .quality = options->quality,
                            .panorama = options->panorama,
                            .balance = options->balance,
                            .use_thread = options->server != NULL,
                            .use_plain_arrays = (uint8_t)options->plain_arrays,
                            /* to whom a server is a stranger, so is its ground */
                            .place_known = options->server == NULL,
                            .no_views = !options->views,
                            .no_reserve = !options->reserve,
                            .hidden = (enum ff_hidden)options->hidden };
    desc.backend = backend_of(options->backend);
    desc.frame_format = options->backend == FLY_SOFT ? C3D_RGBA8888 : C3D_RGB565;
    int rc = ff_client_create(&desc, &world->client);
    if (rc != FF_OK) {
        world->client = NULL;
        return fail("client", rc);
    }
    ff_client_set_show(world->client, options->show);
    if (world->relevance) sim_relevance_ask(world->relevance, asked_for_reserve, world->client);
    return 0;
}

int fly_world_open(fly_world *world, const fly_options *options)
{
    memset(world, 0, sizeof *world);
    world->options = options;
    if (open_ground(world) || open_reference(world) || open_link(world) || open_tape(world) ||
        open_surface(world) || open_client(world))
        return -1;
    return 0;
}

void fly_world_close(fly_world *world)
{
    fly_reference_close(&world->reference);
    if (world->surface) (void)world->surface_api->make_current(world->surface);
    if (world->client) ff_client_destroy(world->client);
    if (world->options->server && world->stream.close) world->stream.close(world->stream.state);
    if (world->link) sim_server_free(&world->server);
    if (world->surface) {
        (void)world->surface_api->make_current(world->surface);
        world->surface_api->close(world->surface);
    }
    sim_link_destroy(world->link);
    sim_relevance_destroy(world->relevance);
    sim_auditor_destroy(world->auditor);
    sim_ground_free(&world->true_ground);
    sim_ground_free(&world->path_ground);
    ff_packs_close(&world->locals);
    ff_packs_close(&world->packs);
    free(world->memory);
}
