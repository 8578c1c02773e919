#include "ff_far_rule.h"

#include "../farfield.h"
#include "../terrain/ff_spread.h"
#include "../../protocol/ff_assert.h"

/* A pair: to begin with, and to keep to it. */
static const uint32_t skyline_q8[2] = { 448, 205 }, share_error_q8[2] = { 141, 63 };
/* So many in ten thousand pixels of the picture. */
static const uint32_t any_pixels[2] = { 10, 5 }, paint_pixels[2] = { 50, 30 };

#define LINK_SHARE     4
#define LINK_UNKNOWN   1000  /* bytes a second */
#define IDLE_BYTES_S   10    /* what is next to nothing */
#define NEARER_BYTES   10000 /* of a set with a nearer front, at most */
#define SHORT_TIMES    4     /* as many pixels of error as were asked for */
#define SHORT_SHARE    4     /* of the share of the link */
#define RICHER_PERCENT 70    /* of its share of the link, for more than was chosen */
#define PAINT_BYTES    600   /* of a set, and one for so many pixels: median of five grounds */
#define PIXELS_A_BYTE  4
#define TRIANGLES_Q8   320 /* log2 triangles for log2 of how much finer */
#define FINER_Q8       205 /* and the other way round */

/* From the richest to the one that takes least. */
static const ff_far_choice steps[] = { { FF_FAR_PAINT, -2, 0 }, { FF_FAR_PAINT, -1, 0 },
                                       { FF_FAR_PAINT, 0, 0 },  { FF_FAR_PAINT, 1, 0 },
                                       { FF_FAR_PAINT, 2, 0 },  { FF_FAR_PAINT, 2, 1 },
                                       { FF_FAR_FINS, 0, 0 },   { FF_FAR_FINS, 2, 0 },
                                       { FF_FAR_OFF, 0, 0 } };
#define USUAL_STEP 2
#define FINS_STEP  6
#define NONE_STEP  8
FF_STATIC_ASSERT(sizeof steps / sizeof *steps == NONE_STEP + 1);

/* What error becomes, of 256, when far ground is drawn as finely as near ground, all of it as
 * coarsely as the limit of triangles then asks for. */
static uint32_t alone_q8(const ff_far_case *of)
{
    if (of->coarse <= 1 || !of->ground.nodes || of->ground_px_q8 <= 0 || of->asked_px_q8 <= 0)
        return 256;
    int32_t coarse_log_q8 = ff_log2_q8((uint64_t)of->coarse << 8) - 8 * 256,
            near_log_q8 = ff_log2_q8((uint64_t)of->ground_px_q8),
            then_log_q8 = ff_log2_q8((uint64_t)of->asked_px_q8);
    if (of->triangles_max) {
        uint64_t far = (uint64_t)of->triangles * of->ground.far_nodes / of->ground.nodes;
        uint64_t all = of->triangles - far +
                       (far * ff_exp2_q8(coarse_log_q8 * TRIANGLES_Q8 / 256 + 8 * 256) >> 8);
        int32_t more_log_q8 = ff_log2_q8(all ? all : 1) - ff_log2_q8(of->triangles_max),
                limit_log_q8 = near_log_q8 + more_log_q8 * FINER_Q8 / 256;
        if (limit_log_q8 > then_log_q8) then_log_q8 = limit_log_q8;
    }
    int32_t log_q8 = then_log_q8 - near_log_q8 - coarse_log_q8;
    if (log_q8 >= 0) return 256;
    return log_q8 <= -8 * 256 ? 1 : ff_exp2_q8(log_q8 + 8 * 256);
}

static int pays(const ff_far_case *of, int kept)
{
    const ff_far_ground *ground = &of->ground;
    if (!of->window ||
        (uint64_t)ground->pixels[FF_FAR_NEARER] * 10000 < (uint64_t)of->window * any_pixels[kept])
        return 0;
    uint64_t part_q8 = alone_q8(of), error_q16 = ground->error_q8 * part_q8;
    if (ground->skyline_q8 * part_q8 >= (uint64_t)skyline_q8[kept] << 8) return 1;
    return !of->has_images && error_q16 * ground->pixels[FF_FAR_NEARER] / of->window >=
                                  (uint64_t)share_error_q8[kept] << 8;
}

static uint64_t bytes_of(const ff_far_case *of, const ff_far_choice *choice)
{
    uint64_t fins = (uint64_t)of->width * 3 / 2;
    if (choice->use != FF_FAR_PAINT) return fins;
    uint64_t paint = PAINT_BYTES + of->ground.pixels[choice->rung + FF_FAR_NEARER] / PIXELS_A_BYTE;
    return fins + (choice->shift ? paint * 2 / 5 : paint);
}

/* Triangles are so short that near ground, too, is not what it should be. */
static int is_short(const ff_far_case *of)
{
    return of->asked_px_q8 > 0 && of->ground_px_q8 / SHORT_TIMES >= of->asked_px_q8;
}

/* Whether sets of a kind take no more than a part of the link: bytes * speed / life. */
static int affordable(const ff_far_case *of, const ff_far_choice *choice, unsigned percent)
{
    if (choice->use == FF_FAR_OFF) return 1;
    uint64_t bytes_s = (of->link_bytes_s ? of->link_bytes_s : LINK_UNKNOWN) / LINK_SHARE;
    if (choice->rung < 0) {
        if (bytes_of(of, choice) > NEARER_BYTES) return 0;
        uint64_t most = is_short(of) ? bytes_s / SHORT_SHARE : IDLE_BYTES_S;
        bytes_s = bytes_s < most ? bytes_s : most;
    }
    uint64_t life_wu = (uint64_t)of->life_wu * ff_far_times_q8(choice->rung) >> 8;
    return bytes_of(of, choice) * (uint64_t)of->speed_wu_s * 100 <= bytes_s * life_wu * percent;
}

static unsigned step_of(const ff_far_choice *choice)
{
    unsigned step = 0;
    while (step < NONE_STEP &&
           (steps[step].use != choice->use || steps[step].rung != choice->rung ||
            steps[step].shift != choice->shift))
        step++;
    return step;
}

ff_far_choice ff_far_choose(const ff_far_case *of, const ff_far_choice *now)
{
    unsigned kept = step_of(now), step = of->has_images && !is_short(of) ? USUAL_STEP : 0;
    FF_ASSERT(of->life_wu > 0 && of->speed_wu_s >= 0);
    if (!pays(of, kept != NONE_STEP)) return steps[NONE_STEP];
    if (of->no_paint || (uint64_t)of->ground.pixels[FF_FAR_NEARER] * 10000 <
                            (uint64_t)of->window * paint_pixels[kept < FINS_STEP])
        step = FINS_STEP;
    while (!affordable(of, &steps[step], step < kept ? RICHER_PERCENT : 100)) step++;
    FF_ASSERT(step <= NONE_STEP);
    return steps[step];
}
