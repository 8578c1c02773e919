/* ADDR:PORT as text. */
#ifndef SYS_ADDRESS_H
#define SYS_ADDRESS_H

/* "HOST:PORT" or "[HOST]:PORT" taken apart; 1 when well formed, port 0 to 65535. An empty host is
 * allowed for listening. */
int sys_address_split(const char *address, char host[128], char port[8]);

#endif
