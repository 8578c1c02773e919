/* A ground's heights on disk, so that decoding a large pack is done once for many flights: a head,
 * then the rows as they lie in memory. The file is of this machine only. A file that does not fit
 * the pack is not an error: the pack is decoded and the file written again. */
#include "sim_ground_local.h"

#include <string.h>

static void make_head(const sim_ground *ground, uint32_t checksum, sim_ground_head *head)
{
    memset(head, 0, sizeof *head);
    memcpy(head->magic, "FFGROUN1", sizeof head->magic);
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
    uint64_t bytes = sizeof head +
                     (uint64_t)ground->columns * ground->rows * sizeof *ground->height;
    if (ground->mapping.size == bytes && !memcmp(ground->mapping.bytes, &head, sizeof head)) {
        ground->height = (const uint16_t *)((const uint8_t *)ground->mapping.bytes + sizeof head);
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
    return sys_write_file(path, ground->block,
                          sizeof *head +
                              (size_t)ground->columns * ground->rows * sizeof *ground->height);
}
