#include "sim_link_option.h"

#include <stdio.h>
#include <string.h>

#define NAMES_MAX 63

static int spec_range(const sys_option *option, char *text, size_t room)
{
    const char *profile[NAMES_MAX + 1] = { NULL }, *key[NAMES_MAX + 1] = { NULL };
    char profiles[512], keys[512], more[128] = "";
    for (unsigned i = 0; i < NAMES_MAX && sim_link_profile_at(i); i++)
        profile[i] = sim_link_profile_at(i)->name;
    for (unsigned i = 0; i < NAMES_MAX && sim_link_key_at(i); i++) key[i] = sim_link_key_at(i);
    sys_words_list(profile, profiles, sizeof profiles);
    sys_words_list(key, keys, sizeof keys);
    if (option->words) sys_words_list(option->words, more, sizeof more);
    return snprintf(text, room, "%s%sNAME[,KEY=VALUE...]; NAME: %s; KEY: %s", more,
                    *more ? " or " : "", profiles, keys);
}

static int take_spec(const sys_option *option, const char *text, void *field)
{
    sim_link_desc desc;
    *(sim_link_spec *)field = text;
    if (option->words && sys_word_index(option->words, text) >= 0) return 0;
    return sim_link_parse(text, &desc) == FF_OK ? 0 : SYS_NOT_ONE;
}

const sys_option_type sim_link_spec_option = { "", spec_range, take_spec };
