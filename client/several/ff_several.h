/* Several sources: packs on this device and servers, of one ground or of several. The first ground
 * of the first one has the client's frame; the others join it when they are known. */
#ifndef FF_SEVERAL_H
#define FF_SEVERAL_H

#include "../ff_client_local.h"

/* The pack whose ground is drawn while the first source, a server, has not been heard: a part on
 * this device of what it may have. NULL: there is none. */
const ff_pack *ff_several_stand_in(const ff_client *client);
/* The first source, a server, has told its grounds (ff_client_take_welcome): 1 when they are the
 * one that is drawn in its stead, which it serves from now on; what is held stays. */
int ff_several_keep(ff_client *client);
/* Once the tree of the first ground is made: all others that are known. */
void ff_several_join(ff_client *client);
/* Once an update: servers that have answered. */
void ff_several_look(ff_client *client);
/* 1 when several sources serve the ground of a key: what one lacks another may have. */
int ff_several_shares(ff_client *client, ff_key key);

#endif
