/* Where on Earth the client's frame lies. */
#include "ff_client_local.h"

/* Grounds that are drawn together are projected alike: whichever source says it will do. */
int ff_client_geo(ff_client *client, ff_geo *geo)
{
    uint8_t value[FF_ABOUT_PROJECTION_MAX];
    ff_about_projection projection;
    int bytes = FF_ERR_NOT_FOUND, waits = !client->have_terrain;
    for (unsigned i = 0; bytes < 0 && client->have_terrain && i < client->source_count; i++) {
        if (i > 0 && ff_client_source_state(client, i) != FF_OK) continue;
        bytes = ff_client_source_about(client, i, FF_ABOUT_PROJECTION, value, sizeof value);
        waits |= bytes == FF_ERR_AGAIN;
    }
    if (bytes < 0) return waits ? FF_ERR_AGAIN : bytes;
    int rc = ff_about_read_projection(value, bytes, &projection);
    return rc == FF_OK ? ff_geo_make(geo, &projection, &client->info) : rc;
}
