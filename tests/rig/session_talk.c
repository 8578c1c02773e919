#include "session_talk.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

int session_tell_at(ff_session *session, const ff_message *message, int64_t now_us)
{
    uint8_t bytes[FF_CAPS_BYTES_MAX + FF_MESSAGE_HEADER_MAX];
    int count = ff_message_encode(message, bytes, sizeof bytes);
    assert_true(count > 0);
    int rc = ff_session_receive(session, bytes, (size_t)count, now_us);
    if (rc >= 0) assert_int_equal(rc, count);
    return rc;
}

ff_message session_heard(ff_session *session)
{
    static uint8_t copy[FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX];
    const uint8_t *bytes;
    ff_message message;
    memset(&message, 0, sizeof message);
    size_t count = ff_session_output(session, &bytes);
    if (count == 0) return message;
    count = count < sizeof copy ? count : sizeof copy;
    memcpy(copy, bytes, count);
    int used = ff_message_decode(copy, count, &message);
    assert_true(used > 0);
    ff_session_sent(session, (size_t)used);
    return message;
}

void session_greet(ff_session *session)
{
    assert_true(session_tell(session, &(ff_message){ .type = FF_MSG_HELLO,
                                                     .u.hello = { FF_PROTOCOL_VERSION, 0 } }) > 0);
    assert_true(session_tell(session, &(ff_message){ .type = FF_MSG_CAPS }) > 0);
    assert_int_equal(session_heard(session).type, FF_MSG_WELCOME);
}

ff_message session_deep_view(void)
{
    ff_message ask = { .type = FF_MSG_GET, .kind = FF_KIND_VIEW };
    ask.u.view = (ff_get_view){ .id = 2,
                                .pitch = (uint16_t)-16000,
                                .position_wu = { 1000 * FF_WU_PER_METRE, 1000 * FF_WU_PER_METRE,
                                                 5000 * FF_WU_PER_METRE },
                                .focal_q8 = 256 * 256,
                                .width = 256,
                                .height = 256,
                                .measure = FF_VIEW_BY_PIXELS,
                                .allowed_q8 = 1,
                                .reach_wu = INT32_MAX,
                                .fine_wu = INT32_MAX,
                                .coarse = 1,
                                .bytes_max = UINT32_MAX,
                                .roots = 1,
                                .count = 1 };
    return ask;
}
