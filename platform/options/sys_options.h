/* The command line. A program's options are one list, a row for each option; parsing, defaults,
 * ranges, errors and --help come from it, and the man page from --help. A row also declares the
 * field its value goes to, so that an option is one row and its use:
 *
 *   #define FLY_OPTIONS(OPTION, HEADING) \
 *       HEADING("The flight") \
 *       OPTION(sys_real, speed_kmh, "speed", "KMH", "150", SYS_REAL(0, 1e5, "km/h"), "how fast")
 *   typedef struct fly_options { FLY_OPTIONS(SYS_FIELD, SYS_NO_FIELD) ... } fly_options;
 *
 *   #define ROW(type, field, name, value, fallback, range, help) \
 *       SYS_OPTION(fly_options, type, field, name, value, fallback, help, range)
 *   static const sys_option row[] = { FLY_OPTIONS(ROW, SYS_HEADING) };
 *   #undef ROW
 *
 * Columns of a row:
 *   type      the field's C type. Its sys_option_type is called `type`_option; types of other rooms
 *             (a link, a quality) work as those below do
 *   field     where the value goes
 *   name      without dashes; NULL: an argument that is no option
 *   value     what --help calls the value, NULL when there is none
 *   fallback  the value when none is given; NULL: the field stays as the program has set it
 *   range     SYS_WHOLE, SYS_REAL, SYS_WORDS, SYS_BIT, SYS_FLAGS or SYS_ANY
 *   help      --help adds range and fallback
 *
 * All programs end with one of enum sys_exit. Nothing is allocated. */
#ifndef SYS_OPTIONS_H
#define SYS_OPTIONS_H

#include <stddef.h>
#include <stdint.h>

enum sys_exit { SYS_EXIT_DONE, SYS_EXIT_FAILED, SYS_EXIT_USAGE };

enum sys_option_flag {
    SYS_NEEDED = 1,
    SYS_REPEATABLE = 2, /* the values add up; of all others the last one given counts */
    SYS_LETTER = 4,     /* -o stands for --output */
    SYS_ALONE = 8,      /* given, what is needed otherwise may be missing */
    SYS_FOLLOWED = 16   /* arguments up to the next option are more of its values */
};

typedef struct sys_option sys_option;

enum { SYS_NOT_ONE = -1, SYS_TOO_MANY = -2 }; /* what reading a value answers, besides 0 */

typedef struct sys_option_type {
    /* What a value is: "--name: x is not " NOUN RANGE. */
    const char *noun;
    /* Writes the range as snprintf would, "1 to 64 s"; NULL: the noun says all. */
    int (*range)(const sys_option *option, char *text, size_t room);
    /* Reads `text` into the field: 0, SYS_NOT_ONE or SYS_TOO_MANY. */
    int (*take)(const sys_option *option, const char *text, void *field);
} sys_option_type;

struct sys_option {
    const char *name, *value, *fallback, *help;
    const sys_option_type *type; /* NULL: a heading, `help` says which */
    size_t field;
    union {
        struct {
            uint64_t low, high;
        } whole;
        struct {
            double low, high;
        } real;
        const char *const *words; /* NULL at the end */
        unsigned bit;
    };
    const char *unit; /* of whole and real; "" for none */
    unsigned flags;   /* enum sys_option_flag */
};

typedef struct sys_program {
    const char *name, *version;
    const char *usage; /* "--pack PACK [OPTION]..." */
    const char *about; /* the first sentence is the man page's one line */
    const char *more;  /* after the options; NULL: nothing */
    const sys_option *option;
    size_t option_count; /* rows, headings too: at most 64 */
} sys_program;

/* 0: go on; 1: --help or --version has been answered; -1: wrong usage, told in one line on
 * stderr. Names may be shortened as long as one option alone begins so. */
int sys_options_parse(const sys_program *program, void *options, int argc, char **argv);
/* "NAME: ..." on stderr; returns -1. */
int sys_options_fail(const sys_program *program, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void sys_options_help(const sys_program *program);

/* ---- types; `field` after parsing ---- */
typedef int sys_flag;           /* 1 when given; takes no value */
typedef int sys_switch;         /* on 1, off 0 */
typedef int sys_word;           /* index of one of SYS_WORDS */
typedef const char *sys_choice; /* one of SYS_WORDS itself */
typedef const char *sys_text;
typedef const char *sys_address;   /* ADDR:PORT to connect to, well formed */
typedef const char *sys_listening; /* the same to listen on: ADDR may be empty, PORT 0 */
typedef uint32_t sys_whole;
typedef uint64_t sys_seed;
typedef double sys_real;
typedef unsigned sys_bits; /* SYS_BIT of it is set when given */
typedef struct sys_size {
    uint16_t width, height; /* each within SYS_WHOLE */
} sys_size;
typedef struct sys_texts { /* repeatable; the program sets text and room before parsing */
    const char **text;
    size_t count, room;
} sys_texts;
enum { SYS_UNSET = -1 }; /* of a switch or word without fallback, when the program has set it so */

extern const sys_option_type sys_flag_option, sys_switch_option, sys_word_option, sys_choice_option,
    sys_text_option, sys_address_option, sys_listening_option, sys_whole_option, sys_seed_option,
    sys_real_option, sys_bits_option, sys_size_option, sys_texts_option;

/* For other rooms' types: the decimal number at *text (digits, or digits.digits) times `scale`,
 * rounded, in integers alone; *text moves behind it. 0, or SYS_NOT_ONE: no number, or one beyond
 * `high`. */
int sys_decimal(const char **text, uint32_t scale, uint64_t high, uint64_t *value);
/* A whole number from `low` to `high` at *text, likewise. */
int sys_whole_at(const char **text, uint64_t low, uint64_t high, uint64_t *value);
/* Index of `text` among words, or SYS_NOT_ONE. */
int sys_word_index(const char *const *words, const char *text);
/* "a, b or c" as snprintf would. */
int sys_words_list(const char *const *words, char *text, size_t room);

/* ---- macros for rows ---- */
/* clang-format off */
#define SYS_FIELD(type, field, name, value, fallback, range, help) type field;
#define SYS_NO_FIELD(...)
#define SYS_OPTION(options, type, field, name, value, fallback, help, ...) \
    { name, value, fallback, help, &type##_option, offsetof(options, field), __VA_ARGS__ },
#define SYS_HEADING(text) { .help = text },

#define SYS_ANY                          .flags = 0
#define SYS_FLAGS(flag)                  .flags = flag
#define SYS_WHOLE(least, most, of)       .whole = { least, most }, .unit = of
#define SYS_REAL(least, most, of)        .real = { least, most }, .unit = of
#define SYS_WORDS(list)                  .words = list
#define SYS_BIT(number)                  .bit = number
/* clang-format on */

#endif
