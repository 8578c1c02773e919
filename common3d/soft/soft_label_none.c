/* Stands in for soft_label.c where labels are left out: none is drawn. */
#include "soft_local.h"

void soft_label(void *state, const c3d_placed_label *label) { (void)state, (void)label; }
