#include "sys_options.h"

#include "sys_output.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define ROWS_MAX 64

typedef struct parser {
    const sys_program *program;
    char *options, **argv;
    int argc, at;
    uint64_t given;              /* bit per row of the program */
    const sys_option *following; /* the option given last when it is SYS_FOLLOWED, else NULL */
} parser;

int sys_options_fail(const sys_program *program, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    fprintf(stderr, "%s: ", program->name);
    vfprintf(stderr, format, list);
    fputc('\n', stderr);
    va_end(list);
    return -1;
}

static uint64_t bit_of(const parser *p, const sys_option *option)
{
    return (uint64_t)1 << (option - p->program->option);
}

static const char *dashes(const sys_option *option) { return option->name ? "--" : ""; }

static const char *name_of(const sys_option *option)
{
    return option->name ? option->name : option->value;
}

static int refuse(const parser *p, const sys_option *option, const char *text, int rc)
{
    char range[1024] = "";
    if (rc == SYS_TOO_MANY)
        return sys_options_fail(p->program, "%s%s: too many, with %s", dashes(option),
                                name_of(option), text);
    if (option->type->range) (void)option->type->range(option, range, sizeof range);
    return sys_options_fail(p->program, "%s%s: %s is not %s%s", dashes(option), name_of(option),
                            *text ? text : "\"\"", option->type->noun, range);
}

static int store(parser *p, const sys_option *option, const char *text)
{
    p->given |= bit_of(p, option);
    int rc = option->type->take(option, text, p->options + option->field);
    return rc ? refuse(p, option, text, rc) : 0;
}

/* The option of this name, or the only one that begins so; NULL: none, or several. */
static const sys_option *find(const parser *p, const char *name, size_t length)
{
    const sys_option *found = NULL;
    int count = 0;
    for (size_t i = 0; i < p->program->option_count; i++) {
        const sys_option *option = &p->program->option[i];
        if (!option->name || strncmp(option->name, name, length)) continue;
        if (!option->name[length]) return option;
        found = option;
        count++;
    }
    return count == 1 && length ? found : NULL;
}

static const sys_option *find_letter(const parser *p, char letter)
{
    for (size_t i = 0; i < p->program->option_count; i++) {
        const sys_option *option = &p->program->option[i];
        if (option->flags & SYS_LETTER && option->name[0] == letter) return option;
    }
    return NULL;
}

/* --name, --name=VALUE, --name VALUE, -n VALUE, -nVALUE. */
static int take_option(parser *p, const char *word)
{
    int is_long = word[1] == '-';
    size_t length = strcspn(word + 2, "=");
    const char *value = is_long ? (word[2 + length] ? word + 2 + length + 1 : NULL)
                                : (word[2] ? word + 2 : NULL);
    const sys_option *option = is_long ? find(p, word + 2, length) : find_letter(p, word[1]);
    if (!option) return sys_options_fail(p->program, "unknown option %s; try --help", word);
    p->following = option->flags & SYS_FOLLOWED ? option : NULL;
    if (!option->value)
        return value ? sys_options_fail(p->program, "--%s: takes no value", option->name)
                     : store(p, option, NULL);
    if (!value && p->at < p->argc && strncmp(p->argv[p->at], "--", 2)) value = p->argv[p->at++];
    if (!value)
        return sys_options_fail(p->program, "--%s: %s is missing", option->name, option->value);
    return store(p, option, value);
}

static int take_argument(parser *p, const char *word)
{
    if (p->following) return store(p, p->following, word);
    for (size_t i = 0; i < p->program->option_count; i++) {
        const sys_option *option = &p->program->option[i];
        if (option->type && !option->name &&
            (!(p->given & bit_of(p, option)) || option->flags & SYS_REPEATABLE))
            return store(p, option, word);
    }
    return sys_options_fail(p->program, "unexpected argument %s; try --help", word);
}

static int check_needed(const parser *p)
{
    const sys_option *missing = NULL;
    for (size_t i = p->program->option_count; i-- > 0;) {
        const sys_option *option = &p->program->option[i];
        int given = (p->given & bit_of(p, option)) != 0;
        if (given && option->flags & SYS_ALONE) return 0;
        if (!given && option->flags & SYS_NEEDED) missing = option;
    }
    if (!missing) return 0;
    return sys_options_fail(p->program, "%s%s%s%s is missing; try --help", dashes(missing),
                            missing->name ? missing->name : "", missing->name ? " " : "",
                            missing->value);
}

static int answer(const sys_program *program, const char *word)
{
    if (!strcmp(word, "--help"))
        sys_options_help(program);
    else if (!strcmp(word, "--version"))
        printf("%s %s\n", program->name, program->version);
    else
        return 0;
    return 1;
}

int sys_options_parse(const sys_program *program, void *options, int argc, char **argv)
{
    parser p = { .program = program, .options = options, .argv = argv, .argc = argc, .at = 1 };
    int only_arguments = 0, rc = 0;
    assert(program->option_count <= ROWS_MAX);
    sys_output_watch(program->name);
    for (size_t i = 0; i < program->option_count; i++) {
        const sys_option *option = &program->option[i];
        rc = option->fallback
                 ? option->type->take(option, option->fallback, p.options + option->field)
                 : 0;
        assert(rc == 0);
    }
    while (!rc && p.at < argc) {
        const char *word = argv[p.at++];
        if (only_arguments || word[0] != '-' || !word[1])
            rc = take_argument(&p, word);
        else if (!strcmp(word, "--"))
            only_arguments = 1, p.following = NULL;
        else if (!(rc = answer(program, word)))
            rc = take_option(&p, word);
    }
    return rc ? rc : check_needed(&p);
}
