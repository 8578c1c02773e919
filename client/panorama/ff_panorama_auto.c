#include "ff_panorama_auto.h"

#include "ff_panorama_rules.h"
#include "../../protocol/ff_assert.h"

#define TYPICAL          4 /* a quarter of the bound: what ground is off by in 19 pixels of 20 */
#define TYPICAL_MAX_Q8   (24 * 256)
#define FAR_SHARE        3
#define LINK_SHARE       16
#define LINK_SHARE_DRAWN 8

int32_t ff_panorama_worth_q8(const ff_panorama_case *of, int drawn)
{
    FF_ASSERT(of->focal_q8 > 0 && of->front_wu > 0 && of->speed_wu_s >= 0);
    if (!of->face_size || !of->link_bytes_s) return 0;
    if (of->ground_px_q8 < of->asked_px_q8 + of->asked_px_q8 / 2) return 0;
    if ((uint64_t)of->far_triangles * FAR_SHARE < of->triangles) return 0;
    /* a face is two focal lengths wide */
    int32_t half_texel_q8 = of->focal_q8 / of->face_size;
    int32_t typical_q8 = of->ground_px_q8 / TYPICAL;
    if (typical_q8 > TYPICAL_MAX_Q8) typical_q8 = TYPICAL_MAX_Q8;
    int32_t left_q8 = typical_q8 - half_texel_q8;
    if (left_q8 <= 0) return 0;
    int64_t way_wu = ff_panorama_sideways_max(left_q8, of->front_wu, of->focal_q8),
            forwards_wu = ff_panorama_forwards_max(left_q8, of->front_wu, of->half_width_q8);
    way_wu = forwards_wu < way_wu ? forwards_wu : way_wu;
    uint64_t share = drawn ? LINK_SHARE_DRAWN : LINK_SHARE;
    /* bytes a second = set_bytes * speed / way */
    uint64_t needed = (uint64_t)of->set_bytes * share * (uint64_t)of->speed_wu_s;
    return needed <= (uint64_t)of->link_bytes_s * (uint64_t)way_wu ? left_q8 : 0;
}
