/* Learning the tables of far sets (SPEC.md, 5.3) from packs: paint and fins of sectors as the
 * server makes them. */
#ifndef TRAIN_FAR_H
#define TRAIN_FAR_H

#include "../../protocol/far/ff_fins_local.h"
#include "../../protocol/picture/ff_paint_local.h"

/* What a sector is made of. */
typedef struct train_vista {
    const char *path;
    ff_paint_source paint; /* columns 0: none */
    uint8_t *needed;
    ff_fin_vertex *vertex;
    uint32_t count;
} train_vista;

typedef struct train_vistas {
    train_vista *vista;
    unsigned count, room;
} train_vistas;

typedef struct train_far_tables {
    ff_paint_tables paint;
    uint16_t fins[FF_FINS_CONTEXTS];
} train_far_tables;

/* Adds what is seen of a pack. 0 or -1 (said). */
int train_vistas_add(train_vistas *vistas, const char *path);
void train_vistas_close(train_vistas *vistas);

int train_far_learn(const train_vistas *vistas, train_far_tables *tables);
/* Tells bytes and error of each pack, beside JPEGs of the same error. */
int train_far_measure(const train_vistas *vistas, const train_far_tables *tables);
/* Writes ff_paint_tables.c and ff_fins_table.c. 0 or -1 (said). */
int train_far_write(const char *folder, const train_far_tables *tables);

#endif
