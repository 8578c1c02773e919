/* The tables as C. */
#ifndef TRAIN_WRITE_H
#define TRAIN_WRITE_H

#include "../../protocol/trained/ff_trained.h"

#include <stdio.h>

/* `count` numbers from `at` on, 16 bits each, in lines. */
void train_put_numbers(FILE *out, const void *at, size_t count, int is_signed);
/* 0 or -1 (said). */
int train_write(const char *path, const ff_trained *tables);

#endif
