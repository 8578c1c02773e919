#include "fly_world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int fail_text(const char *text)
{
    fprintf(stderr, "farfield-fly: %s\n", text);
    return -1;
}

static int fail(const char *what, int rc)
{
    fprintf(stderr, "farfield-fly: %s: %s\n", what, ff_error_text(rc));
    return -1;
}

static int fail_place(const char *option, int rc)
{
    fprintf(stderr, "farfield-fly: %s: %s\n", option, sim_spot_why(rc));
    return -1;
}

/* A place of the path in metres, and how high above ground it is there. */
static int find_place(const fly_world *world, const char *option, const sim_spot *place,
                      double xy_m[2], double *height_m)
{
    int32_t xy_wu[2];
    int rc = world->geo_error;
    if (rc == FF_OK) rc = sim_spot_find(place, &world->geo, &world->pack->header.info, xy_wu);
    if (rc != FF_OK) return fail_place(option, rc);
    for (int axis = 0; axis < 2; axis++) xy_m[axis] = (double)xy_wu[axis] / FF_WU_PER_METRE;
    if (place->above_wu >= 0) *height_m = (double)place->above_wu / FF_WU_PER_METRE;
    return 0;
}

static int open_path(fly_world *world)
{
    const fly_options *options = world->options;
    fly_path *path = &world->path;
    double at_m[2], to_m[2];
    fly_path_init(path, options, &world->pack->header.info, &world->grounds.moderate[0]);
    world->geo_error = ff_geo_pack(&world->geo, world->pack);
    if (options->recording.on_earth && world->geo_error != FF_OK)
        return fail_place(options->path_text, world->geo_error);
    if (!options->at.given) return 0;
    if (find_place(world, "--at", &options->at, at_m, &path->height_m)) return -1;
    path->end_height_m = path->height_m;
    if (options->to.given && find_place(world, "--to", &options->to, to_m, &path->end_height_m))
        return -1;
    fly_path_begin_at(path, at_m, options->to.given ? to_m : NULL);
    return 0;
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
    if (fly_grounds_open(&world->grounds, options, &world->packs, &world->locals)) return -1;
    const ff_terrain_info *info = &world->pack->header.info;
    if (open_path(world)) return -1;
    if (options->audit) {
        world->auditor = sim_auditor_create(&world->grounds.truth[0], info, options->audit_step_px);
        if (!world->auditor) return fail("auditor", FF_ERR_MEMORY);
    }
    return 0;
}

/* How the flight begins, and when its first answer may come: as a device knows it that has a
 * satellite receiver and knows its radio. */
static void foresee_start(fly_world *world)
{
    c3d_camera here = { 0 }, later = { 0 };
    fly_path_at(&world->path, 0, &here);
    fly_path_at(&world->path, 1, &later);
    for (int i = 0; i < 2; i++) world->velocity_wu_s[i] = later.pos_wu[i] - here.pos_wu[i];
    world->first_answer_ms = sim_link_answer_ms(&world->options->link);
    if (world->first_answer_ms > FF_FIRST_ANSWER_MS_MAX)
        world->first_answer_ms = FF_FIRST_ANSWER_MS_MAX;
}

static int open_link(fly_world *world)
{
    const fly_options *options = world->options;
    if (options->server) {
        int rc = sys_tcp_client(&world->tcp, options->server, &world->stream);
        return rc == FF_OK ? 0 : fail(options->server, rc);
    }
    foresee_start(world);
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
                           .far = options->far,
                           .hidden = (enum ff_hidden)options->hidden,
                           .no_views = !options->views,
                           .first_answer_ms = world->first_answer_ms };
    memcpy(head.velocity_wu_s, world->velocity_wu_s, sizeof head.velocity_wu_s);
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
    int rc = fly_reference_open(&world->reference, &world->grounds.packs.pack[0],
                                options->size.width, options->size.height);
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

static int asked_for_reserve(void *client, enum ff_kind kind, uint16_t id, ff_key key)
{
    return ff_client_asked_for_reserve(client, kind, id, key);
}

int fly_world_layer(fly_world *world, const char *name)
{
    const ff_pack *pack = &world->grounds.packs.pack[0];
    const char *wanted = strcmp(name, "off") ? name : NULL;
    ff_layers layers;
    ff_pack_layers(pack, &layers);
    int number = wanted ? ff_layers_find(&layers, wanted) : (int)FF_LAYER_NONE;
    if (number < 0) {
        char why[FF_LAYERS_NAMES_MAX + 40] = "no layer of this name; it has:";
        for (unsigned i = 0; i < layers.count; i++)
            snprintf(why + strlen(why), sizeof why - strlen(why), " %s",
                     *layers.name[i] ? layers.name[i] : "one without a name");
        fprintf(stderr, "farfield-fly: --layer %s: %s\n", name, layers.count ? why : "no images");
        return -1;
    }
    fly_reference_layer(&world->reference, (unsigned)number);
    if (world->tape.file) sim_tape_layer(&world->tape, wanted);
    int rc = ff_client_set_layer(world->client, wanted);
    return rc == FF_OK ? 0 : fail("--layer", rc);
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
                            .far = options->far,
                            .balance = options->balance,
                            .use_thread = options->server != NULL,
                            .use_plain_arrays = (uint8_t)options->plain_arrays,
                            /* to whom a server is a stranger, so is its ground */
                            .place_known = options->server == NULL,
                            .first_answer_ms = world->first_answer_ms,
                            .no_views = !options->views,
                            .no_entry = !options->entry,
                            .no_reserve = !options->reserve,
                            .hidden = (enum ff_hidden)options->hidden };
    memcpy(desc.velocity_wu_s, world->velocity_wu_s, sizeof desc.velocity_wu_s);
    desc.backend = backend_of(options->backend);
    desc.frame_format = options->backend == FLY_SOFT ? C3D_RGBA8888 : C3D_RGB565;
    int rc = ff_client_create(&desc, &world->client);
    if (rc != FF_OK) {
        world->client = NULL;
        return fail("client", rc);
    }
    ff_client_set_show(world->client, options->show);
    if (world->auditor) ff_client_watch_fins(world->client, sim_fins_take, &world->fins);
    if (world->relevance) sim_relevance_ask(world->relevance, asked_for_reserve, world->client);
    return options->layer ? fly_world_layer(world, options->layer) : 0;
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
    sim_fins_free(&world->fins);
    fly_grounds_close(&world->grounds);
    ff_packs_close(&world->locals);
    ff_packs_close(&world->packs);
    free(world->memory);
}
