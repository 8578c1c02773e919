/* For protocol/, and for those who write lists: reading and writing little-endian fields with one
 * sticky error (read all, check once). */
#ifndef FF_BYTES_H
#define FF_BYTES_H

#include "ff_terrain.h"

#include <stddef.h>

typedef struct ff_reader {
    const uint8_t *at, *end;
    int error; /* FF_OK, or the first thing that went wrong; reads after it give zero */
} ff_reader;

typedef struct ff_writer {
    uint8_t *at, *end;
    int error;
} ff_writer;

uint64_t ff_read_bytes(ff_reader *in, unsigned count); /* 0..8 bytes, unsigned */
int64_t ff_read_signed(ff_reader *in, unsigned count); /* 1..8 bytes, two's complement */
/* A LEB128 number below 2^32: 7 bits a byte, low bits first; a byte's top bit says that another
 * byte follows. A number longer than it need be (its last byte is 0) is FF_ERR_RANGE. */
uint32_t ff_read_varint(ff_reader *in);
/* The next `count` bytes, not copied; NULL on error. */
const uint8_t *ff_read_span(ff_reader *in, size_t count);

void ff_write_bytes(ff_writer *out, uint64_t value, unsigned count);
void ff_write_varint(ff_writer *out, uint32_t value);
void ff_write_span(ff_writer *out, const uint8_t *bytes, size_t count);
unsigned ff_varint_bytes(uint32_t value);

/* ff_terrain_info as it stands in pack headers and in WELCOME. Reading checks its ranges. */
#define FF_TERRAIN_BYTES 68
void ff_read_terrain(ff_reader *in, ff_terrain_info *info);
void ff_write_terrain(ff_writer *out, const ff_terrain_info *info);

#endif
