/* --event T:WHAT */
#include "fly_options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const plain_words[] = { "low-battery", "battery-ok",  "interruption", "resume",
                                           "cut",         "panorama-on", "panorama-off", NULL };

/* What follows `word` in `text`; NULL when it does not begin so. */
static const char *after(const char *text, const char *word)
{
    size_t length = strlen(word);
    return strncmp(text, word, length) ? NULL : text + length;
}

static int read_place(const char *text, double place[2])
{
    char rest;
    if (sscanf(text, "%lf,%lf%c", &place[0], &place[1], &rest) != 2) return SYS_NOT_ONE;
    for (int axis = 0; axis < 2; axis++)
        if (!(place[axis] >= 0 && place[axis] <= 1)) return SYS_NOT_ONE;
    return 0;
}

/* WORD=DEGREES for the events of one angle. */
static int read_angle(const char *what, fly_event *event)
{
    static const struct {
        const char *word;
        enum fly_event_kind kind;
        double least, most;
    } row[] = { { "turn=", FLY_TURN_BY, -360, 360 },
                { "pitch=", FLY_PITCH, -90, 90 },
                { "fov=", FLY_FOV, SIM_FOV_MIN, SIM_FOV_MAX } };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        const char *value = after(what, row[i].word);
        char *end;
        if (!value) continue;
        event->kind = row[i].kind;
        event->degrees = strtod(value, &end);
        return end != value && !*end && event->degrees >= row[i].least &&
                       event->degrees <= row[i].most
                   ? 0
                   : SYS_NOT_ONE;
    }
    return SYS_NOT_ONE;
}

static int read_what(const char *what, fly_event *event)
{
    const char *value;
    uint64_t budget = 0;
    int rc = sys_word_index(plain_words, what);
    if (rc >= 0) {
        event->kind = (enum fly_event_kind)rc;
        return 0;
    }
    if ((value = after(what, "link="))) {
        event->kind = FLY_LINK;
        return sim_link_parse(value, &event->link) == FF_OK ? 0 : SYS_NOT_ONE;
    }
    if ((value = after(what, "teleport="))) {
        event->kind = FLY_TELEPORT;
        return read_place(value, event->place);
    }
    if ((value = after(what, "layer="))) {
        event->kind = FLY_LAYER;
        event->layer = value;
        return 0;
    }
    if (!(value = after(what, "budget="))) return read_angle(what, event);
    event->kind = FLY_BUDGET;
    rc = sys_whole_at(&value, 0, SIM_BUDGET_MAX, &budget);
    event->budget = (uint32_t)budget;
    return rc || *value ? SYS_NOT_ONE : 0;
}

static int take_event(const sys_option *option, const char *text, void *field)
{
    fly_events *events = field;
    fly_event event = { 0 };
    char *what;
    (void)option;
    event.at_s = strtod(text, &what);
    if (what == text || *what != ':' || !(event.at_s >= 0 && event.at_s <= 1e6) ||
        read_what(what + 1, &event))
        return SYS_NOT_ONE;
    if (events->count == FLY_EVENTS_MAX) return SYS_TOO_MANY;
    events->event[events->count++] = event;
    return 0;
}

static int event_range(const sys_option *option, char *text, size_t room)
{
    char words[128];
    (void)option;
    sys_words_list(plain_words, words, sizeof words);
    return snprintf(text, room,
                    "T 0 to 1e6; WHAT: %s, link=SPEC, teleport=X,Y, each 0 to 1, "
                    "budget=TRIANGLES, turn=DEGREES, -360 to 360, pitch=DEGREES, -90 to 90, "
                    "fov=DEGREES, %g to %g, or layer=NAME",
                    words, SIM_FOV_MIN, SIM_FOV_MAX);
}

const sys_option_type fly_events_option = { "T:WHAT, ", event_range, take_event };
