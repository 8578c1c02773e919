/* Far ground as pictures: at most two sets of cube faces, the one drawn and the one that is coming
 * (Hybrid, section 6.2).
 *
 * A set is taken at one point O. The set that is coming replaces the drawn one only when all of its
 * faces in view are here, so no picture ever mixes two O, and only when it is good here or the
 * drawn one is not. O lies ahead on the viewer's path, so far that the set is just good when it
 * comes: so it serves twice as long as one taken where the viewer is. It is asked for as long
 * before the drawn one is outdated as it will need to come.
 *
 * Faces in view are asked for first. When none of them is missing, the client asks for faces that a
 * viewer who turns will soon see, and for all faces when the viewer has turned lately (by an eighth
 * of a circle within seconds, at most a minute ago). A face that the server found without far
 * ground is not asked for again for that O. Unless hold_back says otherwise, at most one panorama
 * request is out, and no newer O is asked for while a set is coming. A superseded request is
 * cancelled. A set left behind is neither drawn nor waited for: until there is another set, the
 * client draws its own ground round the viewer. */
#ifndef FF_PANORAMA_H
#define FF_PANORAMA_H

#include "../farfield.h"
#include "../ahead/ff_motion.h"
#include "../ask/ff_new_data.h"
#include "ff_panorama_rules.h"
#include "../../protocol/ff_assert.h"

extern const uint8_t ff_panorama_built; /* 0: left out of this build */

#define FF_PANORAMA_MESHES (2 * FF_FACE_COUNT)

typedef struct ff_panorama_set {
    int32_t position_wu[3]; /* O, in the client's frame */
    int32_t front_wu;       /* the front with which it was asked for */
    ff_key key;             /* of its requests */
    int64_t asked_us;
    uint8_t ready;               /* its faces in view are here, or were */
    uint8_t held, empty, failed; /* bit per enum ff_face_name */
    c3d_texture texture[FF_FACE_COUNT];
    c3d_mesh mesh[FF_FACE_COUNT];
    uint16_t height[FF_FACE_COUNT]; /* rows of the texture */
    /* of these rows, those of the image: the first ones */
    uint16_t rows[FF_FACE_COUNT];
    ff_panorama_sight sight; /* of its faces; expected, while the set is on its way */
} ff_panorama_set;
FF_STATIC_ASSERT(FF_FACE_COUNT <= 8 && FF_FACE_SIZE_MAX <= UINT16_MAX); /* held, height */

typedef struct ff_panorama {
    c3d_device *device;
    c3d_strip quad;
    ff_panorama_desc desc;
    const ff_terrain_info *info;
    uint16_t face_size;  /* what memory allows; 0: no panoramas in this block */
    int8_t active, next; /* index in set[] of the drawn and the coming set; -1: none */
    /* the active set; -1: none, or left behind, as after a long flight without a link */
    int8_t shown;
    uint8_t refusals; /* in a row */
    ff_panorama_set set[2];
    uint32_t serial;
    int64_t retry_us; /* nothing is asked for before this time */
    int64_t lead_us;  /* mean time that a set needs to come */
    int32_t yaw;      /* the camera's at yaw_us: some seconds ago, or at its last turn */
    int64_t yaw_us;
    int64_t turns_until_us; /* until then all faces are wanted: the viewer may turn again */
    uint32_t faces, faces_empty;
} ff_panorama;

/* `info` stays where it is. */
void ff_panorama_init(ff_panorama *panorama, c3d_device *device, const ff_panorama_desc *desc,
                      const ff_terrain_info *info, unsigned face_size);
/* Frees what the device holds. */
void ff_panorama_drop(ff_panorama *panorama);
/* z_back_c in force: where the set shown begins, or where one asked for now would.
 * desc.back_plane_wu and desc.error_px_q8 may change at any time: a set taken for another back
 * plane is outdated. */
static inline int32_t ff_panorama_front_wu(const ff_panorama *panorama)
{
    FF_ASSERT(panorama->shown < 0 || panorama->shown == panorama->active);
    return panorama->shown >= 0 ? panorama->set[panorama->shown].front_wu
                                : panorama->desc.back_plane_wu;
}
/* Applies the refresh rules; `hold`: ask for nothing new. 1 when the drawn set or what is wanted
 * changed. */
int ff_panorama_update(ff_panorama *panorama, ff_requests *requests, const c3d_camera *camera,
                       const ff_motion *motion, int hold, int64_t now_us);
/* 1 when the drawn set shows all that the camera sees. */
int ff_panorama_whole(const ff_panorama *panorama, const c3d_camera *camera);
/* Puts what is missing into the ranking under way; soon: bit per face that will soon be in view. */
void ff_panorama_want(const ff_panorama *panorama, ff_requests *requests, const ff_view *view,
                      unsigned soon, int64_t now_us);
/* For the reserve: a face of the set in use, for a viewer who stays. One at a time, because it has
 * kilobytes. */
void ff_panorama_want_reserve(const ff_panorama *panorama, ff_requests *requests,
                              const ff_view *view, int64_t now_us);
/* Takes in a face or a refusal; 1 when it belongs to a set still wanted. */
int ff_panorama_take(ff_panorama *panorama, const ff_new_item *item, int64_t now_us);
/* 1 when the drawn set is outdated and the next one still coming: more panoramas are wanted than
 * come. */
int ff_panorama_late(const ff_panorama *panorama, const c3d_camera *camera);
/* ff_panorama_plan.c. Whether a set is outdated for this camera, or was taken for another back
 * plane. */
int ff_panorama_set_outdated(const ff_panorama *panorama, const ff_panorama_set *set,
                             const c3d_camera *camera);
/* Whether the drawn set will be outdated by the time another one could be here. */
int ff_panorama_outdated_soon(const ff_panorama *panorama, const c3d_camera *camera,
                              const ff_motion *motion);
/* Fills in where a set asked for now is best taken, and what it is expected to show there. */
void ff_panorama_plan(const ff_panorama *panorama, const c3d_camera *camera,
                      const ff_motion *motion, ff_panorama_set *set);
void ff_panorama_draw(const ff_panorama *panorama, int32_t near_wu);

#endif
