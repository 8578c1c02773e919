/* Any bytes as a pack: once as they are, once with a right checksum in the header, so that the
 * reader gets past it; mapped, and read part by part, which must give the same. */
#include "../../protocol/ff_pack.h"
#include "../../protocol/shape/ff_shape.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

#define NODES_TRIED 64

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static int read_all(const uint8_t *bytes, int count)
{
    int sum = 0;

    for (int i = 0; i < count; i++) sum += bytes[i];
    return sum;
}

static void decode_payload(const ff_terrain_info *info, ff_key key, int refinement,
                           const uint8_t *payload, int bytes)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    static uint16_t parent[FF_NODE_HEIGHTS_MAX], heights[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    size_t memory_bytes = ff_decoder_bytes(info);
    void *memory = malloc(memory_bytes);
    ff_decoder *dec = ff_decoder_create(info, memory, memory_bytes);

    assert(dec != NULL);
    if (ff_shape_has_ground(info, key)) residuals.cells = ff_shape_cells(info, key, refinement);
    if (refinement && ff_decode_refinement(dec, payload, (size_t)bytes, &residuals) == FF_OK)
        ff_reconstruct_refinement(info, parent, &residuals, heights, codec_room);
    if (!refinement && ff_decode_root(dec, payload, (size_t)bytes, &residuals) == FF_OK)
        ff_reconstruct_root(info, &residuals, heights, codec_room);
    free(memory);
}

static int read_part(void *context, uint64_t offset, void *out, size_t count)
{
    memcpy(out, (const uint8_t *)context + offset, count);
    return FF_OK;
}

/* A record from the mapping: its bytes, or an error, and the other view's answer is the same. */
static int record_of(const ff_pack *pack, const ff_pack_section *section, ff_key key,
                     const uint8_t **payload)
{
    return section->kind == FF_SECTION_TEXTURE
               ? ff_pack_layer_record(pack, section->codec, key, payload)
               : ff_pack_record(pack, (enum ff_section_kind)section->kind, key, payload);
}

static int both_records(const ff_pack *pack, const ff_pack *read, const ff_pack_section *section,
                        ff_key key, const uint8_t **payload)
{
    const uint8_t *other;
    int rc = record_of(pack, section, key, payload);

    assert(record_of(read, section, key, &other) == rc);
    assert(rc < 0 || memcmp(*payload, other, (size_t)rc) == 0);
    return rc;
}

static void use_pack(const uint8_t *bytes, size_t count)
{
    static uint8_t room[(1u << FF_INDEX_LENGTH_BITS) + FF_RECORD_CRC_BYTES];
    ff_pack pack, read;
    uint64_t bad, records = 0;
    ff_list about;
    volatile int sum = 0;

    int rc = ff_pack_open(&pack, bytes, count);
    assert(ff_pack_open_reader(&read, read_part, (void *)(uintptr_t)bytes, count, room,
                               sizeof room) == rc);
    if (rc != FF_OK) return;
    for (uint32_t s = 0; s < pack.header.section_count; s++) {
        const ff_pack_section *section = &pack.header.section[s];
        records += section->index.records;
        for (uint32_t i = 0; i < NODES_TRIED; i++) {
            const uint8_t *payload;
            ff_key key = ff_key_make(i >> (2 * section->level), section->level,
                                     section->level ? i : 0);
            rc = both_records(&pack, &read, section, key, &payload);
            if (rc < 0) continue;
            sum += read_all(payload, rc);
            if (section->kind != FF_SECTION_TEXTURE)
                decode_payload(&pack.header.info, key, section->kind == FF_SECTION_REFINEMENT,
                               payload, rc);
        }
    }
    if (ff_pack_about(&pack, &about) == FF_OK) {
        ff_list_entry entry;
        for (int n = 0; n < 8; n++) sum += ff_pack_error_text(&pack, -n)[0];
        while (ff_list_next(&about, &entry) > 0)
            sum += read_all(entry.value, (int)entry.byte_count);
    }
    ff_layers layers;
    ff_pack_layers(&pack, &layers);
    assert(layers.count == pack.header.layers);
    records += pack.header.about.kind != 0;
    ff_pack_verify(&pack, &bad);
    assert(bad <= records);
    (void)sum;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    uint8_t *copy;

    use_pack(bytes, count);
    if (count < FF_PACK_HEADER_BYTES) return 0;
    copy = malloc(count);
    memcpy(copy, bytes, count);
    for (uint32_t i = 0, crc = ff_crc32(0, copy, FF_PACK_HEADER_BYTES - 4); i < 4; i++)
        copy[FF_PACK_HEADER_BYTES - 4 + i] = (uint8_t)(crc >> (8 * i));
    use_pack(copy, count);
    free(copy);
    return 0;
}
