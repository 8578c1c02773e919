/* Far ground by a coarse tree, fins and paint: at most two sets of sectors, the one drawn and the
 * one that is coming or that the drawn one fades in over (protocol/far/ff_far.h says what a sector
 * is).
 *
 * The client's own tree draws all ground, what lies beyond the sets' front more coarsely
 * (ff_quality.fine_wu). A set, taken by the server from one point O, lays on it what that lacks:
 * the outlines of ridges as fins, upright strips that stand where the ridge stands, and their
 * colours as paint, thrown from O on tree and fins. So whoever moves sees the tree's parallax, and
 * a set is good for as long as no ground comes into view that O did not see: in the region round O
 * for which it was asked. O lies ahead on the path and above it, because what a climb uncovers is
 * the worst that can happen to it.
 *
 * Sectors in view are asked for first, those that a turn will show when nothing else waits. The set
 * that is coming replaces the drawn one when all its sectors in view are here: within
 * FF_SETS_FADE_US its paint comes over all that wears the other's, and until then the fins of both
 * stand. Ground that no paint covers shows its own colour.
 *
 * While the link is idle the rest of the drawn set comes, too, for whoever turns while there is no
 * link: as fins alone, some 300 to 600 bytes, where the set will be good for FF_SETS_FINS_S more;
 * with paint, 1500 to 8600 bytes at 240 x 320, where it will be for so long that this is
 * FF_SETS_IDLE_BYTES_S at most: for who stays or walks, not for who flies by, to whom paint all
 * round would cost more than all that he sees of the sets. A sector of fins alone that comes into
 * view is asked for again, with paint, and stands as it is until that is here. What is in view
 * pushes out what is not, never the other way round. */
#ifndef FF_SETS_H
#define FF_SETS_H

#include "ff_far_rule.h"
#include "ff_ridges.h"
#include "../farfield.h"
#include "../ahead/ff_motion.h"
#include "../ask/ff_new_data.h"
#include "../ground/ff_terrain_view.h"
#include "../../protocol/ff_assert.h"

extern const uint8_t ff_sets_built; /* 0: left out of this build */

/* Meshes of a sector's fins at most; those of all sectors share a pool. */
#define FF_SETS_CHUNKS  24
#define FF_SETS_FADE_US 300000
/* Sectors that have room for their paint on the device, of both sets. */
#define FF_SETS_TEXTURES 16
#define FF_SETS_SIDE_MIN 64
#define FF_SETS_ALL      ((1u << FF_FAR_SECTORS) - 1)
/* When a set's other sectors are worth asking for: seconds for which it must be good, for fins;
 * bytes a second until it is not, for paint. */
#define FF_SETS_FINS_S        20
#define FF_SETS_IDLE_BYTES_S  10
#define FF_SETS_RESERVE_BYTES 10000 /* of paint all round at most; else fins alone */
/* Of the largest picture of a width, all that a power of two makes of it included. */
#define FF_SETS_TEXELS(side) (2 * (side) * (side))

typedef struct ff_set_sector {
    c3d_mesh mesh[FF_SETS_CHUNKS];
    c3d_strip strip[FF_SETS_CHUNKS];
    c3d_texture paint;
    uint8_t chunks;
    uint16_t width, height; /* of the texture */
    int16_t middle, top;    /* column and row of the texture where the sector's middle and O's
                             * horizon are */
    ff_ridges ridges;       /* of its fins */
} ff_set_sector;

/* A set's requests have its key, those of its reserve these bits besides: a server lets go of them
 * when it is asked for what is in view. */
#define FF_SETS_KEY_RESERVE ((ff_key)1 << 32)
#define FF_SETS_KEY_FINS    ((ff_key)1 << 33) /* fins alone */

/* Where a set is good: from behind_wu behind O to ahead_wu ahead of it along a way, aside_wu to
 * either side, from low_wu to high_wu above O (which may be negative). */
typedef struct ff_set_region {
    uint16_t heading; /* brad16 */
    int32_t behind_wu, ahead_wu, aside_wu, low_wu, high_wu;
} ff_set_region;

typedef struct ff_set {
    int32_t position_wu[3]; /* O, in the client's frame */
    ff_set_region region;
    int32_t front_wu;
    uint16_t focal;      /* texels a unit of tangent, of the fins */
    uint8_t paint_shift; /* texels of the paint are 2^this as large */
    uint8_t painted;     /* paint was asked for */
    int8_t rung;         /* of the choice it was asked by */
    uint8_t ready;       /* its sectors in view are here, or were */
    ff_key key;          /* of its requests; 0: no set */
    int64_t asked_us;
    uint16_t held, empty, failed; /* bit per sector */
    uint16_t bare;                /* of those held: their paint has not come, only their fins */
    uint8_t crowded;              /* it had no room for all: the reserve asks for no more of it */
    uint32_t stamp;               /* another one whenever a sector has come */
    uint32_t whole, whole_bytes;  /* answers with all that was to be had of a sector, their bytes */
    ff_set_sector sector[FF_FAR_SECTORS];
} ff_set;
FF_STATIC_ASSERT(FF_FAR_SECTORS <= 16);

/* Sectors of which nothing more would come, but for paint of the bare ones. */
static inline unsigned ff_sets_known(const ff_set *set)
{
    FF_ASSERT(!(set->held & set->empty) && !((set->held | set->empty) & set->failed));
    return (unsigned)set->held | set->empty | set->failed;
}

typedef struct ff_sets {
    c3d_device *device;
    const ff_terrain_info *info;
    ff_far_desc desc;
    uint16_t side;        /* width of the largest picture, texels: what memory allows; 0: no sets */
    uint32_t paint_bytes; /* on the device, of all sectors, at most */
    uint16_t vertices;    /* of a mesh at most */
    c3d_vertex *scratch;  /* for one mesh */
    uint16_t *indices;    /* for one strip */
    int8_t active, next;  /* index in set[] of the drawn and the coming set; -1: none */
    int8_t under;         /* and of what the drawn one fades in over */
    uint8_t through;      /* how much of that is seen, 256ths; 0: nothing fades */
    int64_t fade_us;      /* when it began */
    uint8_t refusals;     /* in a row */
    uint8_t off;          /* the server has no sets */
    uint16_t seen;        /* bit per sector: in the last view */
    /* what is asked for next; use FF_FAR_OFF: nothing, and ground is drawn as if there were none */
    ff_far_choice choice;
    uint8_t unpaid;   /* no new set is begun for now */
    int32_t front_wu; /* the nearest front, as high as the camera is */
    uint32_t serial, stamps;
    int64_t retry_us, lead_us;
    ff_set set[2];
    uint32_t sectors, sectors_empty, sectors_failed;
    ff_fins_made watch; /* NULL: nobody */
    void *watch_context;
    c3d_projector projector[2][FF_FAR_SECTORS]; /* of the picture under way: ff_sets_aim */
} ff_sets;

/* `info`, `scratch` (of `vertices`) and `indices` (of ff_sets_indices) stay where they are. */
void ff_sets_init(ff_sets *sets, c3d_device *device, const ff_far_desc *desc,
                  const ff_terrain_info *info, unsigned side);
void ff_sets_scratch(ff_sets *sets, c3d_vertex *scratch, uint16_t *indices, unsigned vertices);
/* Indices of a strip through a mesh of so many vertices, at most. */
static inline uint32_t ff_sets_indices(uint32_t vertices) { return 2 * vertices; }
/* Side of a texture that holds any sector's picture at a focal length. */
unsigned ff_sets_side(int32_t focal_q8);
/* 1 while sets are drawn or waited for (by FF_FAR_AUTO: drawn): ground beyond `*fine_wu` of the
 * camera, along x or y, may then be `*coarse` times as wrong. */
int ff_sets_in_use(const ff_sets *sets, const c3d_camera *camera, int32_t *fine_wu,
                   uint8_t *coarse);
/* Where sets are to begin at the nearest, and how long they are good there, for a camera so high
 * above ground. */
int32_t ff_sets_front_wu(const ff_sets *sets, int32_t clearance_wu);
int32_t ff_sets_life_wu(const ff_sets *sets, int32_t clearance_wu);
/* Other settings: what there is of sets goes at once. */
void ff_sets_set(ff_sets *sets, ff_requests *requests, const ff_far_desc *desc);
/* Drops the drawn set, which fades out, and what is coming, at once. */
void ff_sets_leave(ff_sets *sets, ff_requests *requests, int64_t now_us);
/* Plans sets. `clearance_wu`: how high the camera is above ground. 1 when the drawn set or what is
 * wanted changed, and while sets fade. */
int ff_sets_update(ff_sets *sets, ff_requests *requests, const c3d_camera *camera,
                   const ff_motion *motion, int32_t clearance_wu, int hold, int64_t now_us);
/* ff_sets_want.c: puts what is missing into the ranking under way. `soon`: bit per sector that will
 * be in view. */
void ff_sets_want(const ff_sets *sets, ff_requests *requests, const ff_view *view, unsigned soon,
                  int64_t now_us);
/* The same for the reserve: the drawn set's other sectors. */
void ff_sets_want_reserve(const ff_sets *sets, ff_requests *requests, const ff_view *view,
                          const ff_motion *motion, int64_t now_us);
unsigned ff_sets_in_view(const c3d_camera *camera);
/* Takes in a sector or a refusal; 1 when it belongs to a set still wanted. */
int ff_sets_take(ff_sets *sets, const ff_new_item *item, int64_t now_us);

/* ff_sets_plan.c: where a set asked for now is best taken and for which region; and whether a place
 * lies in a set's region. */
void ff_sets_plan(const ff_sets *sets, const c3d_camera *camera, const ff_motion *motion,
                  int32_t clearance_wu, ff_set *set);
int ff_sets_good(const ff_set *set, const int32_t position_wu[3]);

/* ff_sets_draw.c: makes a sector's meshes from its fins. 0: there was no room for some. */
int ff_sets_make_fins(ff_sets *sets, ff_set *set, unsigned sector, const ff_fin_vertex *fin,
                      uint32_t count);
/* Before a picture: where the projectors stand. */
void ff_sets_aim(ff_sets *sets, const c3d_camera *camera);
/* What is thrown on a node of the ground: an ff_throws' `lay`. */
unsigned ff_sets_lay(const void *sets, const ff_terrain_info *info, const ff_drawn *drawn,
                     ff_view_kept *kept, c3d_draw draws[FF_THROWS_MAX],
                     const ff_squares *without[FF_THROWS_MAX]);
/* ff_sets_hidden.c: the squares of a node that ridges of a set hide from its O; `sectors`: bit per
 * sector in which the node lies. */
ff_squares ff_sets_hidden(const ff_set *set, unsigned sectors, const ff_terrain_info *info,
                          const ff_drawn *drawn);
/* The fins, after the ground. */
void ff_sets_draw(const ff_sets *sets, const c3d_camera *camera);

#endif
