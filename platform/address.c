#include "address.h"

#include <stddef.h>
#include <string.h>

int sys_address_split(const char *address, char host[128], char port[8])
{
    const char *colon = strrchr(address, ':');
    if (!colon) return 0;
    const char *first = address, *last = colon;
    if (*address == '[') {
        if (colon - address < 2 || colon[-1] != ']') return 0;
        first++;
        last--;
    } else if (memchr(address, ':', (size_t)(colon - address))) {
        return 0; /* a bare IPv6 address: which colon begins the port? */
    }
    size_t host_size = (size_t)(last - first), port_size = strlen(colon + 1);
    if (host_size >= 128 || port_size == 0 || port_size > 5) return 0;
    if (strspn(colon + 1, "0123456789") != port_size) return 0;
    memcpy(host, first, host_size);
    host[host_size] = 0;
    memcpy(port, colon + 1, port_size + 1);
    unsigned long number = 0;
    for (const char *digit = port; *digit; digit++)
        number = number * 10 + (unsigned long)(*digit - '0');
    return number <= 65535;
}
