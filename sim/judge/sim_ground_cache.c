/* A ground's heights on disk, so that decoding a large pack is done once for many flights: a head,
 * then heights and marks as they lie in memory. The file is of this machine only. A file that does
 * not fit the pack is not an error: the pack is decoded and the file written again. */
#include "sim_ground_local.h"

#include <string.h>

static void make_head(const sim_ground *ground, uint32_t checksum, sim_ground_head *head)
{
    memset(head, 0, sizeof *head);
    memcpy(head->magic, "FFGROUN2", sizeof head->magic);
    head->checksum = checksum;
    head->level = ground->level;
    head->columns = ground->columns;
    head->rows = ground->rows;
}

int sim_ground_cache_open(sim_ground *ground, uint32_t checksum, const char *path)
{
    sim_ground_head head;
    if (sys_map_file(path, &ground->mapping) != FF_OK) {
        ground->mapping.bytes = NULL;
        return 0;
    }
    make_head(ground, checksum, &head);
    if (ground->mapping.size == sim_ground_bytes(ground) &&
        !memcmp(ground->mapping.bytes, &head, sizeof head)) {
        sim_ground_lie(ground, ground->mapping.bytes);
        return 1;
    }
    sys_unmap_file(&ground->mapping);
    ground->mapping.bytes = NULL;
    return 0;
}

int sim_ground_cache_write(const sim_ground *ground, uint32_t checksum, const char *path)
{
    sim_ground_head *head = ground->block;
    make_head(ground, checksum, head);
    return sys_write_file(path, ground->block, (size_t)sim_ground_bytes(ground));
}
