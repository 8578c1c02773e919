/* Shows that the whole core links over the blank port and that the port answers as it says: `make
 * null` builds and runs it. */
#include "../sys.h"

static int clock_steps(void)
{
    int64_t first_us = sys_time_us();
    sys_sleep_us(5000);
    return sys_time_us() >= first_us + 5000;
}

static int network_is_absent(void)
{
    sys_tcp tcp;
    sys_stream stream;
    uint8_t byte = 0;
    return sys_tcp_client(&tcp, "localhost:1", &stream) == FF_ERR_UNSUPPORTED &&
           sys_tcp_accept(0) == FF_ERR_UNSUPPORTED &&
           stream.recv(stream.state, &byte, 1) == FF_ERR_CLOSED &&
           stream.reconnect(stream.state) == FF_ERR_UNSUPPORTED;
}

static int events_pass(void)
{
    sys_event in = { 0 }, out = { 0 };
    in.type = SYS_EVENT_BATTERY;
    return sys_event_inject(&in) == FF_OK && sys_event_take(&out) == 1 && out.type == in.type &&
           sys_event_take(&out) == 0;
}

int main(void)
{
    sys_mapping mapping;
    sys_thread thread;
    int right = clock_steps() && network_is_absent() && events_pass() &&
                sys_map_file("/", &mapping) == FF_ERR_UNSUPPORTED &&
                sys_thread_start(&thread, (void (*)(void *))0, (void *)0) == FF_ERR_UNSUPPORTED &&
                !sys_surface_glfw() && !sys_surface_egl() && !sys_surface_osmesa();
    return right ? 0 : 1;
}
