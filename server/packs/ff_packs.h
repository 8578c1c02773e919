/* Packs in files, mapped, and joined as the grounds of one server (protocol/ff_pack.h). */
#ifndef FF_PACKS_H
#define FF_PACKS_H

#include "../../platform/sys.h"
#include "../../protocol/ff_pack.h"
#include "../../protocol/message/ff_message.h"

#define FF_PACKS_MAX FF_PACKS_JOINED_MAX

typedef struct ff_packs {
    ff_pack pack[FF_PACKS_MAX]; /* the first one has the others joined to it */
    sys_mapping mapping[FF_PACKS_MAX];
    unsigned count;
    char why[200]; /* what was wrong, in words, with the file first */
} ff_packs;

/* Opens and joins them, a server no more than FF_WELCOME_GROUNDS; close it whatever comes back.
 * FF_OK or an error, which `why` tells. */
int ff_packs_open(ff_packs *packs, const char *const *path, size_t count);
/* Opens one more, joined to none. The same. */
int ff_packs_add(ff_packs *packs, const char *path);
void ff_packs_close(ff_packs *packs);

/* Why a pack's ground cannot be joined to the first one's. */
const char *ff_packs_why_apart(int rc);

/* What a pack and those joined to it say of themselves, in `bytes`: of texts each word once
 * (ff_about_add_words), as far as an entry has room; the rest is the first one's. */
ff_list ff_packs_about(const ff_pack *pack, uint8_t bytes[FF_ABOUT_BYTES_MAX]);
/* What a client has to know of them to have their ground together with that of others: the entries
 * of a WELCOME behind the first one's terrain. `lacks`: bits of FF_LACKS_. */
ff_list ff_packs_welcome(const ff_pack *pack, uint32_t lacks, uint8_t bytes[FF_WELCOME_BYTES_MAX]);

#endif
