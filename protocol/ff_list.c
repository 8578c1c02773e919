#include "ff_list.h"

#include "ff_assert.h"
#include "ff_error.h"

int ff_list_next(ff_list *rest, ff_list_entry *entry)
{
    ff_reader in = { rest->bytes, rest->bytes + rest->byte_count, FF_OK };

    if (rest->byte_count == 0) return 0;
    entry->type = (uint8_t)ff_read_bytes(&in, 1);
    entry->byte_count = ff_read_varint(&in);
    entry->value = ff_read_span(&in, entry->byte_count);
    if (in.error != FF_OK) return in.error;
    FF_ASSERT(in.at > rest->bytes && in.at <= in.end);
    rest->bytes = in.at;
    rest->byte_count = (uint32_t)(in.end - in.at);
    return 1;
}

static int length_ok(const ff_list_entry *entry, const ff_list_rule *rule, unsigned rules)
{
    for (unsigned i = 0; i < rules; i++)
        if (rule[i].type == entry->type)
            return entry->byte_count >= rule[i].least && entry->byte_count <= rule[i].most;
    return 1;
}

int ff_list_check(ff_list list, const ff_list_rule *rule, unsigned rules)
{
    ff_list_entry entry;
    unsigned last = 0;
    int rc;

    while ((rc = ff_list_next(&list, &entry)) > 0) {
        if (entry.type <= last || !length_ok(&entry, rule, rules)) return FF_ERR_RANGE;
        last = entry.type;
    }
    return rc;
}

int ff_list_find(ff_list list, unsigned type, const uint8_t **value)
{
    ff_list_entry entry;

    while (ff_list_next(&list, &entry) > 0) {
        if (entry.type != type) continue;
        *value = entry.value;
        return (int)entry.byte_count;
    }
    return FF_ERR_NOT_FOUND;
}

void ff_list_write(ff_writer *out, unsigned type, const uint8_t *value, uint32_t byte_count)
{
    FF_ASSERT(type >= 1 && type <= UINT8_MAX);
    ff_write_bytes(out, type, 1);
    ff_write_varint(out, byte_count);
    ff_write_span(out, value, byte_count);
}
