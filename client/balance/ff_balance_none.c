/* Stands in for ff_balance.c and client_balance.c in builds without balance: everything stays as
 * set. */
#include "../ff_client_local.h"

void ff_client_balance_begin(ff_client *client, int fresh) { (void)client, (void)fresh; }
void ff_client_balance_step(ff_client *client, const c3d_camera *camera, int64_t now_us)
{
    (void)client, (void)camera, (void)now_us;
}
void ff_client_balance_quality(const ff_client *client, ff_quality *quality)
{
    (void)client, (void)quality;
}
void ff_client_balance_stats(const ff_client *client, ff_balance_stats *stats)
{
    (void)client, (void)stats;
}
void ff_client_set_balance(ff_client *client, const ff_balance_desc *desc)
{
    (void)client, (void)desc;
}
void ff_client_frame_cost(ff_client *client, uint32_t cost) { (void)client, (void)cost; }
