#include "ff_about.h"

#include "ff_assert.h"
#include "ff_error.h"

#define PROJECTION_BYTES (2 + 3 * 8)
#define PARAMETER_BYTES  (2 + 8)
#define HEAD_BYTES       4 /* of an entry: type, and the longest length */

enum about_form { TEXT, NUMBERS, CHECKSUM, NAMES };
#define LEAST_OF(form, most) \
    ((form) == TEXT ? 1 : (form) == NAMES ? 2 : (form) == NUMBERS ? PROJECTION_BYTES : (most))

/* clang-format off */
static const ff_list_rule rule[] = {
#define X(entry, name, type, form, most) { type, LEAST_OF(form, most), most },
    FF_ABOUT_LIST(X)
#undef X
};
static const uint8_t form_of[] = {
#define X(entry, name, type, form, most) form,
    FF_ABOUT_LIST(X)
#undef X
};
/* all of them fit, and lengths do not take more than thought */
#define X(entry, name, type, form, most) + HEAD_BYTES + most
FF_STATIC_ASSERT(0 FF_ABOUT_LIST(X) <= FF_ABOUT_BYTES_MAX);
#undef X
/* clang-format on */
#define RULES (sizeof rule / sizeof *rule)
FF_STATIC_ASSERT(FF_ABOUT_BYTES_MAX >> 7 * (HEAD_BYTES - 1) == 0);

/* The character that begins here, and its bytes; 0: none does. */
static uint32_t character(const uint8_t *bytes, uint32_t left, uint32_t *code)
{
    static const uint32_t least[] = { 0, 0, 0x80, 0x800, 0x10000 };
    uint32_t first = bytes[0], count = first < 0x80   ? 1
                                       : first < 0xc0 ? 0
                                       : first < 0xe0 ? 2
                                       : first < 0xf0 ? 3
                                       : first < 0xf8 ? 4
                                                      : 0;
    if (!count || count > left) return 0;
    *code = count == 1 ? first : first & (0x7fu >> count);
    for (uint32_t i = 1; i < count; i++) {
        if ((bytes[i] & 0xc0) != 0x80) return 0;
        *code = *code << 6 | (bytes[i] & 0x3fu);
    }
    return *code >= least[count] && *code <= 0x10ffff && *code >> 11 != 0x1b ? count : 0;
}

/* Those that move the cursor, end a line, or turn the direction of writing. */
static int is_control(uint32_t code)
{
    return code < 0x20 || (code >= 0x7f && code < 0xa0) || (code >= 0x2028 && code <= 0x202e) ||
           (code >= 0x2066 && code <= 0x2069);
}

int ff_about_is_text(const uint8_t *bytes, uint32_t byte_count)
{
    uint32_t code = 0, used;
    for (uint32_t at = 0; at < byte_count; at += used) {
        used = character(bytes + at, byte_count - at, &code);
        if (!used || is_control(code)) return 0;
    }
    return 1;
}

static int value_ok(const ff_list_entry *entry)
{
    for (unsigned i = 0; i < RULES; i++) {
        if (rule[i].type != entry->type) continue;
        if (form_of[i] == TEXT) return ff_about_is_text(entry->value, entry->byte_count);
        if (form_of[i] == NAMES)
            return ff_layers_read(entry->value, entry->byte_count, 0, NULL) == FF_OK;
        return form_of[i] != NUMBERS ||
               (entry->byte_count - PROJECTION_BYTES) % PARAMETER_BYTES == 0;
    }
    return 1;
}

int ff_about_check(ff_list about)
{
    ff_list_entry entry;
    int rc = about.byte_count > FF_ABOUT_BYTES_MAX ? FF_ERR_RANGE
                                                   : ff_list_check(about, rule, RULES);
    while (rc == FF_OK && ff_list_next(&about, &entry) > 0)
        if (!value_ok(&entry)) rc = FF_ERR_RANGE;
    return rc;
}

uint32_t ff_about_bytes_max(uint32_t set)
{
    uint32_t bytes = 0;
    for (unsigned i = 0; i < RULES; i++)
        if (ff_about_in(set, rule[i].type)) bytes += HEAD_BYTES + rule[i].most;
    return bytes;
}

int ff_about_select(ff_list about, uint32_t set, uint8_t *out, uint32_t capacity)
{
    ff_writer writer = { out, out + capacity, FF_OK };
    ff_list_entry entry;
    while (ff_list_next(&about, &entry) > 0)
        if (ff_about_in(set, entry.type))
            ff_list_write(&writer, entry.type, entry.value, entry.byte_count);
    return writer.error != FF_OK ? writer.error : (int)(writer.at - out);
}

uint32_t ff_about_whole(ff_list about, uint32_t checksum)
{
    const uint8_t *value;
    if (ff_list_find(about, FF_ABOUT_WHOLE, &value) != 4) return checksum;
    ff_reader in = { value, value + 4, FF_OK };
    return (uint32_t)ff_read_bytes(&in, 4);
}

int ff_about_get_projection(ff_list about, ff_about_projection *projection)
{
    const uint8_t *value = NULL;
    int bytes = ff_list_find(about, FF_ABOUT_PROJECTION, &value);
    return ff_about_read_projection(value, bytes, projection);
}

int ff_about_read_projection(const uint8_t *value, int byte_count, ff_about_projection *projection)
{
    if (byte_count < PROJECTION_BYTES) return FF_ERR_NOT_FOUND;
    ff_reader in = { value, value + byte_count, FF_OK };
    projection->method = (uint16_t)ff_read_bytes(&in, 2);
    projection->semi_major_um = ff_read_signed(&in, 8);
    projection->inverse_flattening = ff_read_signed(&in, 8);
    projection->prime_meridian = ff_read_signed(&in, 8);
    projection->parameters = in.at;
    projection->parameter_count = (uint32_t)(in.end - in.at) / PARAMETER_BYTES;
    return in.error;
}

uint16_t ff_about_parameter(const ff_about_projection *projection, uint32_t number, int64_t *value)
{
    const uint8_t *at = projection->parameters + (size_t)number * PARAMETER_BYTES;
    ff_reader in = { at, at + PARAMETER_BYTES, FF_OK };
    FF_ASSERT(number < projection->parameter_count);
    uint16_t code = (uint16_t)ff_read_bytes(&in, 2);
    *value = ff_read_signed(&in, 8);
    return code;
}
