/* What the server tells its operator: one line an event, plain or JSON. */
#ifndef SERVER_SAY_H
#define SERVER_SAY_H

#include "server.h"

void server_say_listening(const server *shared);
void server_say_child(const server *shared, int renderer, unsigned number, int pid);
/* `status` as of waitpid. */
void server_say_death(const server *shared, int renderer, unsigned number, int pid, int status);
/* Sums over all processes. */
void server_say_stopped(const server *shared);

#endif
