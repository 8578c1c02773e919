/* Numbers in floating point: no program of the device has them. */
#include "sys_options.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

static int real_range(const sys_option *option, char *text, size_t room)
{
    return snprintf(text, room, "%.10g to %.10g%s%s", option->real.low, option->real.high,
                    *option->unit ? " " : "", option->unit);
}

static int take_real(const sys_option *option, const char *text, void *field)
{
    char *end;
    errno = 0;
    double number = strtod(text, &end);
    if (end == text || *end || errno ||
        !(number >= option->real.low && number <= option->real.high))
        return SYS_NOT_ONE;
    *(sys_real *)field = number;
    return 0;
}

const sys_option_type sys_real_option = { "a number from ", real_range, take_real };
