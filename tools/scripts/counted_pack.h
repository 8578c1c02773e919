/* What programs that decode a pack to be counted begin with; see count_marks.h. */
#ifndef COUNTED_PACK_H
#define COUNTED_PACK_H

#include "../../protocol/ff_pack.h"
#include "count_marks.h"

#include <stdio.h>
#include <stdlib.h>

static ff_pack pack;

static int fail(const char *what)
{
    fprintf(stderr, "%s\n", what);
    exit(1);
}

/* Reads the pack that is the only argument. */
static void open_pack(int argc, char **argv)
{
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
    if (!file || fseek(file, 0, SEEK_END)) fail("PACK, and nothing else, is to be told");
    size_t bytes = (size_t)ftell(file);
    rewind(file);
    void *text = malloc(bytes);
    if (!text || fread(text, 1, bytes, file) != bytes) fail("the pack cannot be read");
    fclose(file);
    if (ff_pack_open(&pack, text, bytes)) fail("it is no pack");
}

#endif
