/* The emulator's way to its server: a link model in this process, and behind it a real server over
 * TCP or the server's own logic over a pack. The profile can be changed while flying: the
 * connection is lost and made again, as between two radio cells.
 */
#ifndef VIEW_LINK_H
#define VIEW_LINK_H

#include "../link/sim_server.h"

typedef struct view_link view_link;

/* `address` of a server or else `pack`; `spec` as for sim_link_parse, NULL: no limits. `stream` is
 * the client's end and belongs to the thread that runs ff_client_work. FF_OK, FF_ERR_MEMORY,
 * FF_ERR_ARGUMENT (address or spec), FF_ERR_NOT_FOUND (profile). */
int view_link_create(const char *address, const ff_pack *pack, const char *spec, view_link **link,
                     sys_stream *stream);
/* Not while a client still uses the stream. */
void view_link_destroy(view_link *link);
/* The next profile of sim_link_profile_at, after the last one no limits. Any thread; takes effect
 * when the worker comes by. */
void view_link_cycle(view_link *link);
/* Name of the profile chosen. */
const char *view_link_name(view_link *link);

#endif
