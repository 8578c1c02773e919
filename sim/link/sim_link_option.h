/* A link on the command line. */
#ifndef SIM_LINK_OPTION_H
#define SIM_LINK_OPTION_H

#include "../../platform/options/sys_options.h"
#include "sim_link.h"

/* A text that sim_link_parse takes, or one of SYS_WORDS. Its help names all profiles and keys. */
typedef const char *sim_link_spec;
extern const sys_option_type sim_link_spec_option;

#define SIM_SEED_MAX 9007199254740992 /* JSON tells whole numbers up to here */

/* clang-format off */
#define SIM_LINK_OPTIONS(OPTION) \
    OPTION(sys_text, down_trace, "down-trace", "FILE", NULL, SYS_ANY, \
           "a recorded link in Mahimahi's format in place of the rate, to the client") \
    OPTION(sys_text, up_trace, "up-trace", "FILE", NULL, SYS_ANY, "the same, to the server") \
    OPTION(sys_seed, seed, "seed", "N", "1", SYS_WHOLE(0, SIM_SEED_MAX, ""), \
           "of the link's chances: the same seed, the same link")
/* clang-format on */

#endif
