#include "sys_options.h"

#include <stdio.h>
#include <string.h>

#define COLUMNS     100
#define TEXT_COLUMN 26 /* where the help of an option begins */

/* Prints `text` from `column` on, wrapped between words, each further line from `indent` on. A word
 * joins what stands before it unless `text` begins with a space. Returns the column reached. */
static unsigned put(const char *text, unsigned column, unsigned indent)
{
    while (*text) {
        unsigned space = *text == ' ', length = (unsigned)strcspn(text += space, " \n");
        if (column + space + length > COLUMNS && space) {
            printf("\n%*s", (int)indent, "");
            column = indent;
            space = 0;
        }
        column += (unsigned)printf("%*s%.*s", (int)space, "", (int)length, text);
        text += length;
        if (*text != '\n') continue;
        putchar('\n');
        column = 0;
        text++;
    }
    return column;
}

/* " (1 to 64; default 2; may be repeated)". */
static void put_range(const sys_option *option, unsigned column)
{
    char range[1024] = "", line[1200];
    const char *fallback = option->fallback;
    int repeatable = (option->flags & SYS_REPEATABLE) != 0 && option->name;
    if (option->type->range) (void)option->type->range(option, range, sizeof range);
    if (!*range && !fallback && !repeatable) return;
    const char *before_default = *range && fallback ? "; " : "";
    const char *before_repeat = repeatable && (*range || fallback) ? "; " : "";
    snprintf(line, sizeof line, " (%s%s%s%s%s%s)", range, before_default,
             fallback ? "default " : "", fallback ? fallback : "", before_repeat,
             repeatable ? "may be repeated" : "");
    put(line, column, TEXT_COLUMN);
}

static void put_option(const sys_option *option)
{
    unsigned column = 0;
    if (!option->type) {
        printf("\n%s:\n", option->help);
        return;
    }
    column += (unsigned)printf("  ");
    if (option->flags & SYS_LETTER) column += (unsigned)printf("-%c, ", option->name[0]);
    if (option->name) column += (unsigned)printf("--%s", option->name);
    if (option->value) column += (unsigned)printf("%s%s", option->name ? " " : "", option->value);
    /* help2man wants two spaces before the text */
    if (column + 2 > TEXT_COLUMN) {
        putchar('\n');
        column = 0;
    }
    printf("%*s", (int)(TEXT_COLUMN - column), "");
    put_range(option, put(option->help, TEXT_COLUMN, TEXT_COLUMN));
    putchar('\n');
}

void sys_options_help(const sys_program *program)
{
    static const sys_option usual[] = {
        { .name = "help", .help = "shows this and ends", .type = &sys_flag_option },
        { .name = "version", .help = "tells the version and ends", .type = &sys_flag_option }
    };
    int has_headings = 0;
    printf("Usage: %s %s\n\n", program->name, program->usage);
    put(program->about, 0, 0);
    puts("\n");
    for (size_t i = 0; i < program->option_count; i++) {
        has_headings |= !program->option[i].type;
        put_option(&program->option[i]);
    }
    if (has_headings) putchar('\n');
    for (size_t i = 0; i < 2; i++) put_option(&usual[i]);
    putchar('\n');
    if (program->more) put(program->more, 0, 0), puts("\n");
    puts("Exit status: 0 done, 1 failed while working, 2 wrong usage.");
}
