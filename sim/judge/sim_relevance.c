#include "sim_relevance.h"

#include "../../protocol/message/ff_parts.h"
#include "sim_cover.h"
#include "sim_cube.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BUCKETS     4096u
#define NONE        SIZE_MAX
#define RAY_STEP_PX 4
#define ASKED       ((size_t)UINT16_MAX + 1)
#define FARS        64     /* far sets out at once; more are no client's */
#define LOOK_US     250000 /* faces are looked for so often: pictures change little meanwhile */

/* What a request asked for, by its id. */
typedef struct asked {
    enum ff_kind kind;
    ff_key key;
    int32_t position_wu[3]; /* faces and sectors */
    int reserve;
    unsigned chain; /* sim_talk_asked */
} asked;

typedef struct answer {
    enum ff_kind kind;
    ff_key key;             /* heights: the node made (roots) or refined; images */
    int32_t position_wu[3]; /* faces and sectors */
    unsigned sector, face, face_size;
    /* of each column of the face the rows that show ground: first[column] to before
     * first[face_size + column]; NULL: the face is empty */
    uint16_t *first;
    uint32_t bytes;
    int64_t came_us;
    double drawn; /* the share of it that was drawn in time */
    int supports, hidden, reserve;
    int view;               /* 1: a part of one */
    int used;               /* 1: drawn or needed by what was drawn, whenever that was */
    uint64_t support_frame; /* the last in which it was found to */
    uint32_t pixels, seen;  /* of a face, in one frame: in the window; and not hidden */
    uint64_t frame;         /* the last frame that marked it */
    size_t next;            /* the next answer in its bucket */
} answer;

/* Bytes of one direction that do not make a whole message yet. */
typedef struct half {
    uint8_t *bytes;
    size_t count, capacity;
} half;

struct sim_relevance {
    sys_stream inner;
    const int64_t *now_us;
    half down, up;
    asked *asked; /* by id */
    asked *queue; /* without a number: a ring from queue_first to queue_end, answered in order */
    size_t queue_first, queue_end;
    asked view;         /* the last one asked for */
    uint16_t far[FARS]; /* the numbers of sets that are not whole, oldest first */
    size_t far_count;
    ff_parts parts;
    answer *answer; /* in order of arrival */
    size_t count, capacity, judged_count, first_young;
    size_t bucket[BUCKETS];
    uint64_t frame;
    sim_relevance_is_reserve is_reserve; /* NULL: nothing is */
    void *reserve_context;
    sim_mesh mesh;
    sim_cover cover;      /* of the frame that looks for faces */
    int64_t next_look_us; /* for faces */
    sim_relevance_figures figures;
    int rc;
};

/* ---- what came ---- */

static size_t bucket_of(enum ff_kind kind, ff_key key)
{
    return (size_t)((key * FF_KIND_COUNT + kind) * UINT64_C(0x9E3779B97F4A7C15) >> 52) % BUCKETS;
}

/* The latest answer of this kind and key. */
static answer *find(sim_relevance *relevance, enum ff_kind kind, ff_key key)
{
    for (size_t i = relevance->bucket[bucket_of(kind, key)]; i != NONE;
         i = relevance->answer[i].next) {
        answer *a = &relevance->answer[i];
        if (a->kind == kind && a->key == key) return a;
    }
    return NULL;
}

static void keep(sim_relevance *relevance, answer a)
{
    relevance->figures.came[ff_kind[a.kind].data] += a.bytes;
    relevance->figures.reserve_came += a.reserve ? a.bytes : 0;
    relevance->figures.views_came += a.view ? a.bytes : 0;
    if (relevance->count == relevance->capacity) {
        size_t more = relevance->capacity ? 2 * relevance->capacity : 1024;
        answer *grown = realloc(relevance->answer, more * sizeof *grown);
        if (!grown) {
            relevance->rc = FF_ERR_MEMORY;
            free(a.first);
            return;
        }
        relevance->answer = grown;
        relevance->capacity = more;
    }
    a.came_us = *relevance->now_us;
    if (ff_kind[a.kind].asks == FF_ASKS_NODE) {
        size_t *bucket = &relevance->bucket[bucket_of(a.kind, a.key)];
        a.next = *bucket;
        *bucket = relevance->count;
    }
    relevance->answer[relevance->count++] = a;
}

/* The rows that show ground; none in a column where the face does not tell. NULL: out of memory. */
static uint16_t *take_spans(sim_relevance *relevance, const ff_face *face)
{
    unsigned size = face->face_size;
    uint16_t *first = calloc(2u * size, sizeof *first);
    if (!first) {
        relevance->rc = FF_ERR_MEMORY;
        return NULL;
    }
    if (ff_face_columns_decode(face->columns, face->columns_bytes, size, face->row_count, first,
                               first + size) != FF_OK)
        memset(first, 0, 2u * size * sizeof *first);
    for (unsigned i = 0; i < 2u * size; i++) first[i] = (uint16_t)(first[i] + face->top_row);
    return first;
}

/* What a message answers; NULL: nothing that was asked for. */
static const asked *asked_by(sim_relevance *relevance, const ff_message *message)
{
    uint16_t id = message->type == FF_MSG_ANSWER ? ff_message_id(message) : message->u.failed.id;
    if (message->type == FF_MSG_ANSWER && message->kind == FF_KIND_VIEW) return &relevance->view;
    if (message->type == FF_MSG_ANSWER && message->kind == FF_KIND_FAR)
        return relevance->far_count ? &relevance->asked[relevance->far[0]] : NULL;
    if (id) return &relevance->asked[id];
    return relevance->queue_first < relevance->queue_end
               ? &relevance->queue[relevance->queue_first++ % ASKED]
               : NULL;
}

/* A far set is whole, or will not be. */
static void end_far(sim_relevance *relevance, uint16_t id)
{
    size_t kept = 0;
    for (size_t i = 0; i < relevance->far_count; i++)
        if (relevance->far[i] != id) relevance->far[kept++] = relevance->far[i];
    relevance->far_count = kept;
}

/* Of a part: which node it is of. 0: of none. */
static int find_part(sim_relevance *relevance, const ff_part *part, answer *a)
{
    int named;
    return ff_parts_next(&relevance->parts, &a->kind, &a->key, &named) &&
           ff_parts_take(&relevance->parts, part) == FF_OK && part->byte_count > 0;
}

static void take_answer(sim_relevance *relevance, const ff_message *message, size_t bytes)
{
    const asked *q = asked_by(relevance, message);
    const ff_face *face = &message->u.face;
    answer a = { .bytes = (uint32_t)bytes };
    if (!q || ff_kind[q->kind].answered_by != ff_kind[message->kind].answered_by) {
        relevance->figures.came[FF_DATA_OVERHEAD] += (double)bytes;
        return;
    }
    sim_talk_answered(&relevance->figures.talk, q->chain);
    a.kind = q->kind;
    a.key = q->key;
    a.reserve = q->reserve;
    if (ff_kind[a.kind].brings == FF_BRINGS_PARTS) {
        a.view = 1;
        if (!find_part(relevance, &message->u.part, &a)) {
            relevance->figures.came[FF_DATA_OVERHEAD] += (double)bytes;
            return;
        }
    } else if (ff_kind[a.kind].brings == FF_BRINGS_FACE) {
        memcpy(a.position_wu, q->position_wu, sizeof a.position_wu);
        a.face = face->face;
        a.face_size = face->face_size;
        if (!(face->flags & FF_FACE_EMPTY)) a.first = take_spans(relevance, face);
    } else if (ff_kind[a.kind].brings == FF_BRINGS_FAR) {
        memcpy(a.position_wu, q->position_wu, sizeof a.position_wu);
        a.sector = message->u.far.sector;
        relevance->figures.fins_came += message->u.far.fins_bytes;
        if (message->u.far.flags & FF_FACE_LAST) end_far(relevance, relevance->far[0]);
    }
    keep(relevance, a);
}

/* What no picture shows, and what answers nothing that was asked, is overhead. */
static void take_down(sim_relevance *relevance, const ff_message *message, size_t bytes)
{
    sim_talk_down(&relevance->figures.talk, message, bytes);
    if (message->type == FF_MSG_ANSWER) {
        take_answer(relevance, message, bytes);
        return;
    }
    relevance->figures.came[FF_DATA_OVERHEAD] += (double)bytes;
    if (message->type == FF_MSG_ROOTS) (void)ff_parts_roots(&relevance->parts, &message->u.roots);
    if (message->type == FF_MSG_EDGE)
        (void)ff_parts_edge(&relevance->parts, message->u.edge.needed);
    if (message->type == FF_MSG_FAILED && !message->u.failed.id) asked_by(relevance, message);
    if (message->type == FF_MSG_FAILED) end_far(relevance, message->u.failed.id);
    if (message->type == FF_MSG_CANCELLED) end_far(relevance, message->u.cancel.id);
}

/* Where to note what is asked for: by its number, or last in the queue. */
static asked *place_for(sim_relevance *relevance, const ff_message *message)
{
    uint16_t id = ff_message_id(message);
    return message->kind == FF_KIND_VIEW ? &relevance->view
           : id                          ? &relevance->asked[id]
                                         : &relevance->queue[relevance->queue_end++ % ASKED];
}

static void take_up(sim_relevance *relevance, const ff_message *message, size_t bytes)
{
    sim_talk_up(&relevance->figures.talk, message, bytes);
    if (message->type != FF_MSG_GET) return;
    asked *q = place_for(relevance, message);
    *q = (asked){ .kind = message->kind, .chain = sim_talk_asked(&relevance->figures.talk) };
    switch ((enum ff_kind_asks)ff_kind[q->kind].asks) {
        case FF_ASKS_NODE: q->key = message->u.get.key; break;
        case FF_ASKS_VIEW: ff_parts_begin(&relevance->parts, &message->u.view); break;
        case FF_ASKS_FAR:
            if (relevance->far_count < FARS)
                relevance->far[relevance->far_count++] = message->u.get_far.id;
            memcpy(q->position_wu, message->u.get_far.position_wu, sizeof q->position_wu);
            break;
        case FF_ASKS_PANORAMA:
            memcpy(q->position_wu, message->u.panorama.position_wu, sizeof q->position_wu);
            break;
    }
    if (relevance->is_reserve)
        q->reserve = relevance->is_reserve(relevance->reserve_context, message->kind,
                                           ff_message_id(message), q->key);
}

/* Bytes down that are no message. */
static void take_nothing(sim_relevance *relevance, size_t bytes)
{
    relevance->figures.came[FF_DATA_OVERHEAD] += (double)bytes;
    relevance->figures.talk.framing += (double)bytes;
}

/* Adds bytes of one direction and takes whole messages off its front. */
static void take_bytes(sim_relevance *relevance, half *part, const uint8_t *bytes, size_t count)
{
    ff_message message;
    size_t at = 0;
    int used = 0;
    if (part->count + count > part->capacity) {
        size_t more = 2 * (part->count + count);
        uint8_t *grown = realloc(part->bytes, more);
        if (!grown) {
            relevance->rc = FF_ERR_MEMORY;
            return;
        }
        part->bytes = grown;
        part->capacity = more;
    }
    memcpy(part->bytes + part->count, bytes, count);
    part->count += count;
    while (at < part->count &&
           (used = ff_message_decode(part->bytes + at, part->count - at, &message)) > 0) {
        if (part == &relevance->down)
            take_down(relevance, &message, (size_t)used);
        else
            take_up(relevance, &message, (size_t)used);
        at += (size_t)used;
    }
    if (used < 0) { /* nonsense: the client will close */
        if (part == &relevance->down) take_nothing(relevance, part->count - at);
        at = part->count;
    }
    memmove(part->bytes, part->bytes + at, part->count - at);
    part->count -= at;
}

/* ---- the tap ---- */

static int tap_send(void *state, const uint8_t *bytes, size_t count)
{
    sim_relevance *relevance = state;
    int sent = relevance->inner.send(relevance->inner.state, bytes, count);
    if (sent > 0) take_bytes(relevance, &relevance->up, bytes, (size_t)sent);
    return sent;
}

static int tap_recv(void *state, uint8_t *bytes, size_t capacity)
{
    sim_relevance *relevance = state;
    int count = relevance->inner.recv(relevance->inner.state, bytes, capacity);
    if (count > 0) take_bytes(relevance, &relevance->down, bytes, (size_t)count);
    return count;
}

static int tap_reconnect(void *state)
{
    sim_relevance *relevance = state;
    take_nothing(relevance, relevance->down.count);
    relevance->down.count = relevance->up.count = 0;
    relevance->queue_first = relevance->queue_end = relevance->far_count = 0;
    return relevance->inner.reconnect(relevance->inner.state);
}

static void tap_close(void *state)
{
    sim_relevance *relevance = state;
    relevance->inner.close(relevance->inner.state);
}

sim_relevance *sim_relevance_create(sys_stream *stream, const ff_terrain_info *info,
                                    const int64_t *now_us)
{
    sim_relevance *relevance = calloc(1, sizeof *relevance);
    if (!relevance) return NULL;
    relevance->asked = calloc(ASKED, sizeof *relevance->asked);
    relevance->queue = calloc(ASKED, sizeof *relevance->queue);
    if (sim_mesh_make(&relevance->mesh, info) != FF_OK || !relevance->asked || !relevance->queue) {
        sim_relevance_destroy(relevance);
        return NULL;
    }
    for (size_t i = 0; i < BUCKETS; i++) relevance->bucket[i] = NONE;
    relevance->now_us = now_us;
    relevance->inner = *stream;
    stream->state = relevance;
    stream->send = tap_send;
    stream->recv = tap_recv;
    stream->close = stream->close ? tap_close : NULL;
    stream->reconnect = stream->reconnect ? tap_reconnect : NULL;
    return relevance;
}

void sim_relevance_ask(sim_relevance *relevance, sim_relevance_is_reserve is_reserve, void *context)
{
    relevance->is_reserve = is_reserve;
    relevance->reserve_context = context;
}

void sim_relevance_destroy(sim_relevance *relevance)
{
    if (!relevance) return;
    free(relevance->down.bytes);
    free(relevance->up.bytes);
    free(relevance->asked);
    free(relevance->queue);
    for (size_t i = 0; i < relevance->count; i++) free(relevance->answer[i].first);
    free(relevance->answer);
    sim_mesh_free(&relevance->mesh);
    sim_cover_free(&relevance->cover);
    free(relevance);
}

/* ---- what is drawn ---- */

static int is_young(const sim_relevance *relevance, const answer *a)
{
    return *relevance->now_us - a->came_us <= SIM_RELEVANCE_US;
}

static void mark(sim_relevance *relevance, answer *a)
{
    if (is_young(relevance, a)) a->drawn = 1;
    a->used = 1;
    a->frame = relevance->frame;
}

/* The latest answer that brought a node: its parent's refinement, or the root itself. */
static answer *bringer(sim_relevance *relevance, ff_key node)
{
    return ff_key_level(node) > 0 ? find(relevance, FF_KIND_REFINEMENT, ff_key_parent(node))
                                  : find(relevance, FF_KIND_ROOT, node);
}

/* Marks the answers that brought the nodes beside a drawn node, without which vertices of its side
 * would be left out, or beside one above it, without which its children could not be drawn, because
 * the cut is restricted; and what these need in turn. */
static void mark_support(sim_relevance *relevance, const ff_terrain_info *info, ff_key node)
{
    for (unsigned side = 0; side < FF_SIDE_COUNT && ff_key_level(node) > 0; side++) {
        ff_key beside = ff_shape_neighbour(info, node, (enum ff_side)side).key;
        answer *a = beside == FF_KEY_NONE ? NULL : bringer(relevance, beside);
        if (!a || a->support_frame == relevance->frame) continue;
        a->support_frame = relevance->frame;
        a->supports |= is_young(relevance, a);
        a->used = 1;
        mark_support(relevance, info, ff_key_parent(beside));
    }
}

static void mark_heights(sim_relevance *relevance, const ff_terrain_info *info, ff_key node)
{
    for (;; node = ff_key_parent(node)) {
        mark_support(relevance, info, node);
        answer *a = bringer(relevance, node);
        if (a && a->frame == relevance->frame) return; /* and all above it */
        if (a) mark(relevance, a);
        if (ff_key_level(node) == 0) return;
    }
}

/* Marks the answers that brought a node which nearer ground hides, and those above it. */
static void mark_hidden(sim_relevance *relevance, ff_key node)
{
    for (;; node = ff_key_parent(node)) {
        answer *a = bringer(relevance, node);
        if (a) a->hidden |= is_young(relevance, a);
        if (ff_key_level(node) == 0) return;
    }
}

/* An image that is drawn may be a difference to those above it. */
static void mark_images(sim_relevance *relevance, const sim_relevance_view *view)
{
    for (size_t i = 0; view->wears && i < relevance->count; i++) {
        answer *a = &relevance->answer[i];
        if (a->kind != FF_KIND_TEXTURE || !view->wears(view->client, a->key)) continue;
        mark(relevance, a);
        while (a && ff_key_level(a->key) > 0) {
            a = find(relevance, FF_KIND_TEXTURE, ff_key_parent(a->key));
            if (a) a->used = 1;
        }
    }
}

/* 1 while a face of the set in use may still be drawn in time; the others are older. */
static int is_sought(const answer *a, const sim_relevance_view *view)
{
    return a->kind == FF_KIND_FACE && a->drawn < 1 &&
           memcmp(a->position_wu, view->panorama_pos_wu, sizeof a->position_wu) == 0;
}

/* 1 when a face has a pixel at a place of the cube, whose size is 1. */
static int face_shows(const answer *a, const sim_cube_place *at)
{
    double row = at->row * a->face_size;
    if (at->face != a->face || !a->first) return at->face == a->face;
    unsigned column = at->column > 0 ? (unsigned)(at->column * a->face_size) : 0;
    if (column >= a->face_size) column = a->face_size - 1;
    return row >= a->first[column] && row < a->first[a->face_size + column];
}

/* Counts a pixel of the picture for the faces that have one there. */
static void count_pixel(sim_relevance *relevance, const sim_relevance_view *view,
                        const double along[3], int hidden)
{
    sim_cube_place at;
    sim_cube_meet(along, 1, &at);
    for (size_t i = relevance->first_young; i < relevance->count; i++) {
        answer *a = &relevance->answer[i];
        if (!is_sought(a, view) || !face_shows(a, &at)) continue;
        a->pixels++;
        a->seen += !hidden;
    }
}

/* Begins to count pixels: how many faces are sought. */
static size_t begin_faces(sim_relevance *relevance, const sim_relevance_view *view)
{
    size_t sought = 0;
    for (size_t i = relevance->first_young; i < relevance->count; i++) {
        answer *a = &relevance->answer[i];
        if (!is_sought(a, view)) continue;
        a->pixels = a->seen = 0;
        sought++;
    }
    return sought;
}

/* An empty face is drawn where any of it is seen, others by the pixels that are. */
static void end_faces(sim_relevance *relevance, const sim_relevance_view *view)
{
    for (size_t i = relevance->first_young; i < relevance->count; i++) {
        answer *a = &relevance->answer[i];
        if (is_sought(a, view) && a->seen)
            a->drawn = fmax(a->drawn, a->first ? (double)a->seen / a->pixels : 1);
    }
}

static void mark_faces(sim_relevance *relevance, const sim_relevance_view *view)
{
    sim_eye eye;
    const c3d_camera *camera = &view->camera;
    if (!view->panorama || *relevance->now_us < relevance->next_look_us ||
        !begin_faces(relevance, view))
        return;
    relevance->next_look_us = *relevance->now_us + LOOK_US;
    int rc = sim_cover_make(&relevance->cover, &relevance->mesh, camera, RAY_STEP_PX, view->drawn,
                            view->drawn_count);
    if (rc != FF_OK) {
        relevance->rc = rc;
        return;
    }
    sim_eye_of(camera, &eye);
    const uint32_t *node = relevance->cover.node;
    for (unsigned y = RAY_STEP_PX / 2; y < camera->height; y += RAY_STEP_PX)
        for (unsigned x = RAY_STEP_PX / 2; x < camera->width; x += RAY_STEP_PX) {
            const double pixel[2] = { x + 0.5, y + 0.5 };
            double along[3];
            sim_eye_ray(&eye, pixel, along);
            count_pixel(relevance, view, along, *node++ != 0);
        }
    end_faces(relevance, view);
}

static void mark_sectors(sim_relevance *relevance, const sim_relevance_view *view)
{
    for (size_t i = relevance->first_young; view->far_sectors && i < relevance->count; i++) {
        answer *a = &relevance->answer[i];
        if (a->kind == FF_KIND_FAR && (view->far_sectors >> a->sector & 1u) &&
            memcmp(a->position_wu, view->far_pos_wu, sizeof a->position_wu) == 0)
            mark(relevance, a);
    }
}

void sim_relevance_frame(sim_relevance *relevance, const sim_relevance_view *view)
{
    relevance->frame++;
    sim_mesh_use(&relevance->mesh, &view->grounds);
    while (relevance->first_young<relevance->count && * relevance->now_us -
                                  relevance->answer[relevance->first_young].came_us>
               SIM_RELEVANCE_US)
        relevance->first_young++;
    for (uint32_t i = 0; i < view->drawn_count; i++) {
        const ff_terrain_info *info = sim_mesh_info(&relevance->mesh, &view->drawn[i]);
        mark_heights(relevance, info, view->drawn[i].key);
    }
    for (uint32_t i = view->drawn_count; i < view->in_view_count; i++)
        mark_hidden(relevance, view->drawn[i].key);
    mark_images(relevance, view);
    mark_faces(relevance, view);
    mark_sectors(relevance, view);
}

/* Adds up an answer whose time is over. */
static void judge(sim_relevance_figures *sum, const answer *a)
{
    double unused = (1 - a->drawn) * a->bytes;
    sum->judged[ff_kind[a->kind].data] += a->bytes;
    sum->unused[ff_kind[a->kind].data] += unused;
    if (a->reserve) {
        sum->reserve_judged += a->bytes;
        sum->reserve_unused += unused;
    } else if (a->drawn == 0) {
        sum->supporting += a->supports ? a->bytes : 0;
        sum->hidden += a->hidden && !a->supports ? a->bytes : 0;
    }
}

static double percent_of(double judged, double unused, double overhead)
{
    return judged > overhead ? 100 * (1 - unused / judged) : NAN;
}

/* Of what was judged: heights and images that nothing drawn has needed. */
static void find_waste(const sim_relevance *relevance, sim_relevance_figures *sum)
{
    sum->views_wasted = sum->wasted = sum->wasted_images = 0;
    for (size_t i = 0; i < relevance->judged_count; i++) {
        const answer *a = &relevance->answer[i];
        if (a->used || a->reserve) continue;
        uint8_t data = ff_kind[a->kind].data;
        sum->wasted_images += data == FF_DATA_IMAGES ? a->bytes : 0;
        sum->wasted += data == FF_DATA_HEIGHTS ? a->bytes : 0;
        sum->views_wasted += data == FF_DATA_HEIGHTS && a->view ? a->bytes : 0;
    }
}

int sim_relevance_get(sim_relevance *relevance, sim_relevance_figures *figures)
{
    sim_relevance_figures *sum = &relevance->figures;
    for (; relevance->judged_count < relevance->count; relevance->judged_count++) {
        const answer *a = &relevance->answer[relevance->judged_count];
        if (*relevance->now_us - a->came_us <= SIM_RELEVANCE_US) break;
        judge(sum, a);
    }
    find_waste(relevance, sum);
    double overhead = sum->came[FF_DATA_OVERHEAD], unused = 0;
    sum->judged[FF_DATA_OVERHEAD] = sum->unused[FF_DATA_OVERHEAD] = overhead;
    sum->judged_all = 0;
    for (int data = 0; data < FF_DATA_CLASSES; data++) {
        sum->judged_all += sum->judged[data];
        unused += sum->unused[data];
    }
    sum->percent = percent_of(sum->judged_all, unused, overhead);
    sum->no_reserve_percent = percent_of(sum->judged_all - sum->reserve_judged,
                                         unused - sum->reserve_unused, overhead);
    *figures = *sum;
    return relevance->rc;
}
