#include "sim_fins.h"

#include "../../protocol/ff_error.h"

#include <stdlib.h>
#include <string.h>

static sim_fin *add(sim_fins *fins)
{
    if (fins->count == fins->capacity) {
        size_t more = fins->capacity ? 2 * fins->capacity : 1024;
        sim_fin *grown = realloc(fins->fin, more * sizeof *grown);
        if (!grown) {
            fins->rc = FF_ERR_MEMORY;
            return NULL;
        }
        fins->fin = grown;
        fins->capacity = more;
    }
    return &fins->fin[fins->count++];
}

static int is_of(const sim_fin *fin, ff_key set, unsigned sector)
{
    return fin->set == set && fin->sector == sector;
}

/* Drops what a sector had, unless more of it is coming. */
static void make_way(sim_fins *fins, ff_key set, unsigned sector)
{
    size_t kept = 0;
    if (!fins->count || is_of(&fins->fin[fins->count - 1], set, sector)) return;
    for (size_t i = 0; i < fins->count; i++)
        if (!is_of(&fins->fin[i], set, sector)) fins->fin[kept++] = fins->fin[i];
    fins->count = kept;
}

void sim_fins_take(void *context, ff_key set, unsigned sector, const c3d_vertex *vertex,
                   uint32_t vertices, const uint16_t *index, uint32_t indices)
{
    make_way(context, set, sector);
    for (uint32_t i = 0; i + 2 < indices; i++) {
        const uint16_t *at = index + i;
        if (at[0] == at[1] || at[1] == at[2] || at[0] == at[2]) continue;
        sim_fin *fin = add(context);
        if (!fin) return;
        fin->set = set;
        fin->sector = sector;
        for (int k = 0; k < 3; k++) {
            FF_ASSERT(at[k] < vertices);
            const c3d_vertex *corner = &vertex[at[k]];
            fin->corner_m[k][0] = (double)corner->x / FF_WU_PER_METRE;
            fin->corner_m[k][1] = (double)corner->y / FF_WU_PER_METRE;
            fin->corner_m[k][2] = (double)corner->z / FF_WU_PER_METRE;
        }
    }
}

void sim_fins_forget(sim_fins *fins, ff_key set)
{
    size_t kept = 0;
    for (size_t i = 0; i < fins->count; i++)
        if (fins->fin[i].set >= set) fins->fin[kept++] = fins->fin[i];
    fins->count = kept;
}

void sim_fins_free(sim_fins *fins)
{
    free(fins->fin);
    memset(fins, 0, sizeof *fins);
}
