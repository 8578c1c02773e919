/* Assertions: what the code below a line relies on, said so that a machine checks it.
 *
 * FF_ASSERT(condition) ends the process, with file, line and condition, when what is known to hold
 * does not: a defect of this code. It is on unless NDEBUG is defined, as assert() is: in `make`,
 * `make SAN=1`, tests and whatever simulates. The handheld and bare-metal builds define NDEBUG
 * (cross.mk): there it is no instruction and the condition is never evaluated, so it must not
 * change anything. A program that embeds libfarfield and wants it off builds with CFLAGS=-DNDEBUG.
 *
 * FF_STATIC_ASSERT(condition) is checked by the compiler in every build, in C99 as in C11. It
 * stands outside functions; constants that must agree have one beside them.
 *
 * Never asserted on is what comes from outside: bytes of messages, packs and tapes, arguments of
 * the public functions, the size of the caller's block. That gets an error.
 */
#ifndef FF_ASSERT_H
#define FF_ASSERT_H

#include <assert.h>

/* Not a macro with an argument when on: the message shows the condition as it was written. */
#ifdef NDEBUG
#define FF_ASSERT(condition) ((void)sizeof(!(condition)))
#else
#define FF_ASSERT assert
#endif

#define FF_STATIC_ASSERT(condition) extern char ff_static_assert_holds[(condition) ? 1 : -1]

#endif
