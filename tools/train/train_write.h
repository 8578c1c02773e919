/* The tables as C. */
#ifndef TRAIN_WRITE_H
#define TRAIN_WRITE_H

#include "../../protocol/trained/ff_trained.h"

/* 0 or -1 (said). */
int train_write(const char *path, const ff_trained *tables);

#endif
