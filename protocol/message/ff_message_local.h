/* What the forms of messages share; for ff_message*.c only. */
#ifndef FF_MESSAGE_LOCAL_H
#define FF_MESSAGE_LOCAL_H

#include "ff_message.h"
#include "../ff_bytes.h"

static inline void ff_message_require(int *error, int condition)
{
    FF_ASSERT(*error <= FF_OK);
    if (!condition && *error == FF_OK) *error = FF_ERR_RANGE;
}

#define FF_MESSAGE_KEY_BYTES (1 + 4 + 5) /* at most: level, tile, code */

/* 1 when a message of this kind may ask for it. */
int ff_message_get_ok(const ff_get *get, enum ff_kind kind);
/* A node: a byte of what it is asked for and of its level, tile, code. Read behind that byte. */
void ff_message_write_key(ff_writer *out, uint32_t what, ff_key key);
ff_key ff_message_read_key(ff_reader *in, uint32_t form);
void ff_message_read_rest(ff_reader *in, const uint8_t **bytes, uint32_t *count);

/* WELCOME's first entry: which bytes of the terrain's description are not 0, and these. */
void ff_message_write_terrain(ff_writer *out, const ff_terrain_info *info);
int ff_message_read_terrain(const ff_list_entry *entry, ff_terrain_info *info);
void ff_message_write_view(ff_writer *out, const ff_get_view *view);
void ff_message_read_view(ff_reader *in, ff_get_view *view);
void ff_message_write_get_far(ff_writer *out, const ff_get_far *get);
void ff_message_read_get_far(ff_reader *in, ff_get_far *get);
void ff_message_write_far(ff_writer *out, const ff_far *far);
void ff_message_read_far(ff_reader *in, ff_far *far);

/* ff_message_short.c: the type that such a first byte stands for, FF_MSG_GET or FF_MSG_ANSWER, 0:
 * it is none; whether a message has such a form; the rest as in ff_message.h. */
int ff_short_type(uint8_t byte, enum ff_kind *kind);
int ff_short_has(const ff_message *message);
int ff_short_encode(const ff_message *message, uint8_t *out, size_t capacity);
int ff_short_measure(const uint8_t *bytes, size_t count, uint32_t *header, uint32_t *body);
int ff_short_decode(const uint8_t *bytes, size_t count, ff_message *out);

#endif
