/* Types without floating point: the device has these alone. */
#include "sys_options.h"

#include "../address.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define FRACTION_DIGITS_MAX 9 /* further ones are less than any scale can tell */

int sys_decimal(const char **text, uint32_t scale, uint64_t high, uint64_t *value)
{
    const char *at = *text;
    uint64_t whole = 0, fraction = 0, ten = 1;
    if (*at < '0' || *at > '9') return SYS_NOT_ONE;
    for (; *at >= '0' && *at <= '9'; at++) {
        if (whole > (UINT64_MAX - 9) / 10) return SYS_NOT_ONE;
        whole = whole * 10 + (uint64_t)(*at - '0');
    }
    if (*at == '.' && at[1] >= '0' && at[1] <= '9')
        for (unsigned digits = 0; *++at >= '0' && *at <= '9'; digits++)
            if (digits < FRACTION_DIGITS_MAX) {
                fraction = fraction * 10 + (uint64_t)(*at - '0');
                ten *= 10;
            }
    if (whole > high / scale) return SYS_NOT_ONE;
    *text = at;
    *value = whole * scale + (fraction * scale * 2 + ten) / (2 * ten);
    return *value > high ? SYS_NOT_ONE : 0;
}

int sys_word_index(const char *const *words, const char *text)
{
    for (int i = 0; words[i]; i++)
        if (!strcmp(words[i], text)) return i;
    return SYS_NOT_ONE;
}

int sys_words_list(const char *const *words, char *text, size_t room)
{
    size_t used = 0;
    for (int i = 0; words[i]; i++) {
        const char *before = i == 0 ? "" : words[i + 1] ? ", " : " or ";
        int more = snprintf(used < room ? text + used : NULL, used < room ? room - used : 0, "%s%s",
                            before, words[i]);
        used += (size_t)more;
    }
    return (int)used;
}

static int words_range(const sys_option *option, char *text, size_t room)
{
    return sys_words_list(option->words, text, room);
}

static int take_word(const sys_option *option, const char *text, void *field)
{
    int index = sys_word_index(option->words, text);
    if (index < 0) return SYS_NOT_ONE;
    *(sys_word *)field = index;
    return 0;
}

static int take_choice(const sys_option *option, const char *text, void *field)
{
    int index = sys_word_index(option->words, text);
    if (index < 0) return SYS_NOT_ONE;
    *(sys_choice *)field = option->words[index];
    return 0;
}

static const char *const switch_words[] = { "off", "on", NULL };

static int take_switch(const sys_option *option, const char *text, void *field)
{
    (void)option;
    int index = sys_word_index(switch_words, text);
    if (index < 0) return SYS_NOT_ONE;
    *(sys_switch *)field = index;
    return 0;
}

static int take_flag(const sys_option *option, const char *text, void *field)
{
    (void)option, (void)text;
    *(sys_flag *)field = 1;
    return 0;
}

static int take_bit(const sys_option *option, const char *text, void *field)
{
    (void)text;
    *(sys_bits *)field |= 1u << option->bit;
    return 0;
}

static int take_text(const sys_option *option, const char *text, void *field)
{
    (void)option;
    *(sys_text *)field = text;
    return *text ? 0 : SYS_NOT_ONE;
}

static int take_texts(const sys_option *option, const char *text, void *field)
{
    (void)option;
    sys_texts *texts = field;
    if (texts->count == texts->room) return SYS_TOO_MANY;
    texts->text[texts->count++] = text;
    return *text ? 0 : SYS_NOT_ONE;
}

static int take_address(const sys_option *option, const char *text, void *field)
{
    char host[128], port[8];
    (void)option;
    *(sys_address *)field = text;
    return sys_address_split(text, host, port) && *host && strcmp(port, "0") ? 0 : SYS_NOT_ONE;
}

static int take_listening(const sys_option *option, const char *text, void *field)
{
    char host[128], port[8];
    (void)option;
    *(sys_listening *)field = text;
    return sys_address_split(text, host, port) ? 0 : SYS_NOT_ONE;
}

static int whole_range(const sys_option *option, char *text, size_t room)
{
    return snprintf(text, room, "%" PRIu64 " to %" PRIu64 "%s%s", option->whole.low,
                    option->whole.high, *option->unit ? " " : "", option->unit);
}

int sys_whole_at(const char **text, uint64_t low, uint64_t high, uint64_t *value)
{
    const char *digits = *text;
    uint64_t number = 0;
    *text += strspn(digits, "0123456789");
    if (*text == digits || *text - digits > 18) return SYS_NOT_ONE;
    while (digits < *text) number = number * 10 + (uint64_t)(*digits++ - '0');
    *value = number;
    return number >= low && number <= high ? 0 : SYS_NOT_ONE;
}

static int whole_at(const sys_option *option, const char **text, uint64_t *value)
{
    return sys_whole_at(text, option->whole.low, option->whole.high, value);
}

static int take_seed(const sys_option *option, const char *text, void *field)
{
    return whole_at(option, &text, field) || *text ? SYS_NOT_ONE : 0;
}

static int take_whole(const sys_option *option, const char *text, void *field)
{
    uint64_t number;
    if (whole_at(option, &text, &number) || *text) return SYS_NOT_ONE;
    *(sys_whole *)field = (sys_whole)number;
    return 0;
}

static int take_size(const sys_option *option, const char *text, void *field)
{
    uint64_t width, height;
    if (whole_at(option, &text, &width) || *text++ != 'x' || whole_at(option, &text, &height) ||
        *text)
        return SYS_NOT_ONE;
    *(sys_size *)field = (sys_size){ (uint16_t)width, (uint16_t)height };
    return 0;
}

const sys_option_type sys_flag_option = { "", NULL, take_flag },
                      sys_bits_option = { "", NULL, take_bit },
                      sys_switch_option = { "on or off", NULL, take_switch },
                      sys_word_option = { "", words_range, take_word },
                      sys_choice_option = { "", words_range, take_choice },
                      sys_text_option = { "a text", NULL, take_text },
                      sys_texts_option = { "a text", NULL, take_texts },
                      sys_address_option = { "ADDR:PORT", NULL, take_address },
                      sys_listening_option = { "ADDR:PORT", NULL, take_listening },
                      sys_whole_option = { "a whole number from ", whole_range, take_whole },
                      sys_seed_option = { "a whole number from ", whole_range, take_seed },
                      sys_size_option = { "WIDTHxHEIGHT, each ", whole_range, take_size };
