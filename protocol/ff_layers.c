#include "ff_layers.h"

#include "ff_about.h"
#include "ff_assert.h"
#include "ff_error.h"
#include "ff_key.h"

#include <string.h>

int ff_layer_name_ok(const char *name)
{
    size_t bytes = strlen(name);
    return bytes <= FF_LAYER_NAME_MAX && ff_about_is_text((const uint8_t *)name, (uint32_t)bytes);
}

/* The row of layer `number`. */
static int read_row(ff_reader *row, unsigned number, unsigned grounds, ff_layers *layers)
{
    FF_ASSERT(number < FF_LAYERS_MAX);
    uint32_t bytes = (uint32_t)ff_read_bytes(row, 1);
    const uint8_t *name = ff_read_span(row, bytes);
    if (row->error != FF_OK) return row->error;
    if (bytes > FF_LAYER_NAME_MAX || (number && !bytes) || !ff_about_is_text(name, bytes))
        return FF_ERR_RANGE;
    memcpy(layers->name[number], name, bytes);
    for (unsigned other = 0; other < number; other++)
        if (!strcmp(layers->name[other], layers->name[number])) return FF_ERR_RANGE;
    for (unsigned i = 0; i < grounds; i++) {
        layers->levels[number][i] = (uint8_t)ff_read_bytes(row, 1);
        if (layers->levels[number][i] > FF_KEY_LEVEL_MAX + 1) return FF_ERR_RANGE;
    }
    return row->error;
}

int ff_layers_read(const uint8_t *bytes, uint32_t byte_count, unsigned grounds, ff_layers *layers)
{
    ff_layers own, *read = layers ? layers : &own;
    ff_reader in = { bytes, bytes + byte_count, FF_OK };
    FF_ASSERT(grounds <= FF_LAYER_GROUNDS);
    memset(read, 0, sizeof *read);
    while (in.at < in.end) {
        uint32_t row_bytes = (uint32_t)ff_read_bytes(&in, 1);
        const uint8_t *at = ff_read_span(&in, row_bytes);
        if (in.error != FF_OK) return in.error;
        if (read->count == FF_LAYERS_MAX) return FF_ERR_RANGE;
        ff_reader row = { at, at + row_bytes, FF_OK };
        int rc = read_row(&row, read->count, grounds, read);
        if (rc != FF_OK) return rc;
        read->count++;
    }
    return read->count ? FF_OK : FF_ERR_RANGE;
}

void ff_layers_write(ff_writer *out, const ff_layers *layers, unsigned grounds)
{
    FF_ASSERT(grounds <= FF_LAYER_GROUNDS && layers->count <= FF_LAYERS_MAX);
    for (unsigned i = 0; i < layers->count; i++) {
        uint32_t bytes = (uint32_t)strlen(layers->name[i]);
        ff_write_bytes(out, 1 + bytes + grounds, 1);
        ff_write_bytes(out, bytes, 1);
        ff_write_span(out, (const uint8_t *)layers->name[i], bytes);
        ff_write_span(out, layers->levels[i], grounds);
    }
}

int ff_layers_find(const ff_layers *layers, const char *name)
{
    FF_ASSERT(layers->count <= FF_LAYERS_MAX);
    if (!*name) return layers->count ? 0 : FF_ERR_NOT_FOUND;
    for (int i = 0; i < layers->count; i++)
        if (!strcmp(layers->name[i], name)) return i;
    return FF_ERR_NOT_FOUND;
}
