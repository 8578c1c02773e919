/* Any bytes as a message stream. A message that decodes must encode to the same bytes again: every
 * message has one form only. */
#include "../../protocol/message/ff_message.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void check_columns(const ff_face *face)
{
    uint16_t top[FF_FACE_SIZE_MAX], bottom[FF_FACE_SIZE_MAX], top_again[FF_FACE_SIZE_MAX],
        bottom_again[FF_FACE_SIZE_MAX];
    uint8_t packed[4 * FF_FACE_SIZE_MAX + 8];
    int rc = ff_face_columns_decode(face->columns, face->columns_bytes, face->face_size,
                                    face->row_count, top, bottom);

    if (rc != FF_OK) return;
    for (uint32_t c = 0; c < face->face_size; c++)
        assert(top[c] <= bottom[c] && bottom[c] <= face->row_count);
    rc = ff_face_columns_encode(top, bottom, face->face_size, packed, sizeof(packed));
    assert(rc > 0);
    rc = ff_face_columns_decode(packed, (size_t)rc, face->face_size, face->row_count, top_again,
                                bottom_again);
    assert(rc == FF_OK && memcmp(top, top_again, 2u * face->face_size) == 0 &&
           memcmp(bottom, bottom_again, 2u * face->face_size) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    while (count > 0) {
        ff_message message;
        int used = ff_message_decode(bytes, count, &message);
        if (used <= 0) break;
        assert((size_t)used <= count);
        if (message.type == FF_MSG_ANSWER && message.kind == FF_KIND_FACE &&
            !(message.u.face.flags & FF_FACE_EMPTY))
            check_columns(&message.u.face);
        uint8_t *again = malloc(ff_message_bytes_max(&message));
        assert(ff_message_encode(&message, again, ff_message_bytes_max(&message)) == used);
        assert(memcmp(again, bytes, (size_t)used) == 0);
        free(again);
        bytes += used;
        count -= (size_t)used;
    }
    return 0;
}
