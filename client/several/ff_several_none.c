/* Stands in for ff_several.c in builds for one ground from one source: it has all that there is. */
#include "ff_several.h"

const ff_pack *ff_several_stand_in(const ff_client *client) { return (void)client, NULL; }
int ff_several_keep(ff_client *client) { return (void)client, 0; }
void ff_several_join(ff_client *client)
{
    ff_client_tag_layer(client);
    ff_client_serve(client, &client->first);
}
void ff_several_look(ff_client *client) { (void)client; }
int ff_several_shares(ff_client *client, ff_key key) { return (void)client, (void)key, 0; }

ff_source *ff_client_route(ff_client *client, enum ff_kind kind, ff_key key, unsigned lacks)
{
    (void)lacks;
    return ff_refusals_final(&client->first.refusals, kind, key) ? NULL : &client->first;
}
