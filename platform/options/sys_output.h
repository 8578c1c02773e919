/* Results that are written out: a full disk is an error, in one line. */
#ifndef SYS_OUTPUT_H
#define SYS_OUTPUT_H

#include <stdio.h>

/* Closes a file that results were written to. 0, or -1: not all of them are in it, told as
 * "PROGRAM: cannot write PATH: ..." on stderr. */
int sys_output_close(const char *program, FILE *file, const char *path);
/* When the program ends and not all that it wrote is in its standard output, that is told likewise,
 * and the program ends with SYS_EXIT_FAILED. Once a program: sys_options_parse does it. */
void sys_output_watch(const char *program);

#endif
