/* Relevance: how much of what came down was of use. Measured on the wire and on the picture alone:
 * a tap on the client's stream reads every message both ways, and each frame tells what is drawn.
 *
 * An answer (its whole message, header included) is of use when a frame within SIM_RELEVANCE_US of
 * its arrival draws it:
 *   heights   a node whose heights it brought, or one built on them, lies in the window: a
 *             refinement's residuals add to the heights of all nodes above it, so a drawn node
 *             draws the answers of its whole line of ancestors. Nodes outside the window that only
 *             let a drawn neighbour be as fine as it is, on its whole rim (the cut is restricted),
 *             are not drawn; they are told apart as `supporting`. Nor are nodes in view that the
 *             client left out behind nearer ground: when it asked for them it did not know that
 *             ground yet. They are told apart as `hidden`.
 *   image     the frame draws it on some of its ground: images come from coarse to fine.
 *   face      its set is the one in use: by the share of its pixels in the window that no drawn
 *             ground hides, in the frame with the largest share; an empty face wholly, when any
 *             direction of it is seen. Four times a second every fourth pixel each way is looked
 *             at.
 *   sector    of a far set: its set is the one in use, and the sector may be seen; an empty one
 *             likewise.
 *   reserve   what the client asked for on an idle link without a use in sight. By its purpose most
 *             of it is not drawn in time: the shares with and without it stand side by side.
 *             Whether a request was made for it cannot be seen on the wire, and is all that the
 *             client is asked.
 *
 * Overhead is all else that came: greetings, pongs, refusals, cancellations and what a cut left
 * incomplete. It counts as never drawn.
 */
#ifndef SIM_RELEVANCE_H
#define SIM_RELEVANCE_H

#include "../../platform/sys.h"
#include "../../protocol/ff_kind.h"
#include "sim_mesh.h"
#include "sim_talk.h"

#define SIM_RELEVANCE_US 5000000

/* Bytes since the start. */
typedef struct sim_relevance_figures {
    double came[FF_DATA_CLASSES];
    double judged[FF_DATA_CLASSES]; /* came at least SIM_RELEVANCE_US ago; overhead: at once */
    double unused[FF_DATA_CLASSES]; /* of the judged: not drawn in time */
    double judged_all;              /* sum of judged */
    double fins_came;               /* within came[FF_DATA_FAR]: fins alone, without paint */
    double reserve_came, reserve_judged, reserve_unused; /* within those above */
    /* of unused heights, not the reserve's: those without which a drawn node could not be drawn,
     * and of the others those that nearer ground hid */
    double supporting, hidden;
    /* share of judged_all that was drawn in time; NAN before anything was judged */
    double percent;
    double no_reserve_percent; /* the same without the reserve's answers */
    /* of heights that came with views, and of all but the reserve's; of either what came at least
     * SIM_RELEVANCE_US ago, and nothing drawn has needed so far */
    double views_came, views_wasted, wasted;
    double wasted_images; /* the same of images */
    sim_talk talk;
} sim_relevance_figures;

/* What a frame draws. */
typedef struct sim_relevance_view {
    c3d_camera camera;
    const ff_drawn *drawn; /* drawn_count of them, then those in view that nearer ground hides */
    uint32_t drawn_count, in_view_count;
    /* 1 when the frame draws this image on some of its ground; NULL: none are drawn */
    int (*wears)(const void *client, ff_key image);
    const void *client;
    sim_drawn_grounds grounds; /* their keys number those of the stream's messages first */
    int panorama;              /* 1: a panorama is in use, taken at position_wu */
    int32_t panorama_pos_wu[3];
    unsigned far_sectors;  /* of the far set in use, bit per sector that may be seen; 0: none */
    int32_t far_pos_wu[3]; /* where that was taken */
} sim_relevance_view;

typedef struct sim_relevance sim_relevance;

/* Taps `stream` from here on; the object and *now_us must outlive it. One thread. NULL: out of
 * memory. */
sim_relevance *sim_relevance_create(sys_stream *stream, const ff_terrain_info *info,
                                    const int64_t *now_us);
/* Who tells from now on whether the request of an id, or where it has none (0) of a node, just
 * made, is for the reserve; without, none is. */
typedef int (*sim_relevance_is_reserve)(void *context, enum ff_kind kind, uint16_t id, ff_key key);
void sim_relevance_ask(sim_relevance *relevance, sim_relevance_is_reserve is_reserve,
                       void *context);
void sim_relevance_destroy(sim_relevance *relevance);
void sim_relevance_frame(sim_relevance *relevance, const sim_relevance_view *view);
/* As of *now_us. FF_OK, or FF_ERR_MEMORY when not every answer could be kept. */
int sim_relevance_get(sim_relevance *relevance, sim_relevance_figures *figures);

#endif
