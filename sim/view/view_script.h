/* Scripts drive the emulator as a person would: lines "FRAME COMMAND ARGUMENTS", frames not going
 * back, # begins a comment.
 *
 *   key NAME | down NAME | up NAME     a..z 0..9 + - left right up down pageup pagedown escape
 *                                      enter space shift f1..f12;
 *                                      key lets go in the same frame: for toggles
 *   touch down|move|up X Y             scroll up|down
 *   position X Y Z                     metres from the south-west corner, height above sea
 *   accelerometer X Y Z                thousandths of g
 *   battery low|ok                     interruption begin|end
 *   settle                             let no frame count until nothing more arrives or changes
 *   screenshot FILE                    quit
 */
#ifndef VIEW_SCRIPT_H
#define VIEW_SCRIPT_H

#include "../../platform/sys.h"

#include <stddef.h>

enum view_step_kind { VIEW_STEP_EVENT, VIEW_STEP_SETTLE, VIEW_STEP_SCREENSHOT, VIEW_STEP_QUIT };

typedef struct view_step {
    uint32_t frame;
    enum view_step_kind kind;
    sys_event event;
    char *path; /* SCREENSHOT */
} view_step;

typedef struct view_script {
    view_step *step;
    size_t count, next;
} view_script;

/* 0, or -1 with the reason in `why`. */
int view_script_load(view_script *script, const char *path, char *why, size_t why_bytes);
/* A script of key presses, one for each character, held for VIEW_KEY_FRAMES, then the key after
 * it. */
#define VIEW_KEY_FRAMES 5
int view_script_keys(view_script *script, const char *keys, char *why, size_t why_bytes);
void view_script_free(view_script *script);
/* The next step due at `frame`, or NULL. */
const view_step *view_script_next(view_script *script, uint32_t frame);

/* Name of a key code (static memory, "?" unknown). */
const char *view_key_name(int code);

#endif
