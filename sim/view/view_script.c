#include "view_script.h"

#include "../../protocol/ff_terrain.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_BYTES 1024
#define METRES_MAX 8000000.0

static const struct {
    const char *name;
    int code;
} named_keys[] = { { "left", SYS_KEY_LEFT },      { "right", SYS_KEY_RIGHT },
                   { "up", SYS_KEY_UP },          { "down", SYS_KEY_DOWN },
                   { "pageup", SYS_KEY_PAGE_UP }, { "pagedown", SYS_KEY_PAGE_DOWN },
                   { "escape", SYS_KEY_ESCAPE },  { "enter", SYS_KEY_ENTER },
                   { "space", SYS_KEY_SPACE },    { "shift", SYS_KEY_SHIFT } };
enum { NAMED_KEYS = sizeof named_keys / sizeof *named_keys };

/* Key code of a name, 0 unknown. */
static int key_code(const char *name)
{
    int number, used = 0;
    if (name[0] > ' ' && name[0] < 127 && !name[1]) return name[0];
    for (int i = 0; i < NAMED_KEYS; i++)
        if (!strcmp(name, named_keys[i].name)) return named_keys[i].code;
    if (sscanf(name, "f%d%n", &number, &used) == 1 && !name[used] && number >= 1 && number <= 12)
        return SYS_KEY_F1 + number - 1;
    return 0;
}

const char *view_key_name(int code)
{
    static char name[8];
    for (int i = 0; i < NAMED_KEYS; i++)
        if (named_keys[i].code == code) return named_keys[i].name;
    if (code > ' ' && code < 127)
        snprintf(name, sizeof name, "%c", code);
    else if (code >= SYS_KEY_F1 && code < SYS_KEY_F1 + 12)
        snprintf(name, sizeof name, "f%d", code - SYS_KEY_F1 + 1);
    else
        snprintf(name, sizeof name, "?");
    return name;
}

static int add(view_script *script, const view_step *step)
{
    view_step *grown = realloc(script->step, (script->count + 1) * sizeof *grown);
    if (!grown) return -1;
    script->step = grown;
    script->step[script->count++] = *step;
    return 0;
}

static int add_key(view_script *script, uint32_t frame, int code, int down)
{
    view_step step = { .frame = frame,
                       .kind = VIEW_STEP_EVENT,
                       .event = { .type = SYS_EVENT_KEY, .u.key = { code, down } } };
    return add(script, &step);
}

/* ---- commands: each reads its arguments into a step; 0, or -1 when they are wrong ---- */
typedef int (*reader)(const char *arguments, view_step *step);

static int read_touch(const char *arguments, view_step *step)
{
    static const char *const actions[] = {
        [SYS_POINTER_DOWN] = "down", [SYS_POINTER_MOVE] = "move", [SYS_POINTER_UP] = "up"
    };
    char action[8];
    int x, y, end = 0;
    if (sscanf(arguments, "%7s %d %d%n", action, &x, &y, &end) != 3 || arguments[end] ||
        abs(x) > 32767 || abs(y) > 32767)
        return -1;
    step->event.type = SYS_EVENT_POINTER;
    for (int i = 0; i < 3; i++) {
        if (strcmp(action, actions[i])) continue;
        step->event.u.pointer.action = (enum sys_pointer_action)i;
        step->event.u.pointer.x = x;
        step->event.u.pointer.y = y;
        return 0;
    }
    return -1;
}

/* 1, 0 for the two words allowed, -1 otherwise. */
static int either(const char *word, const char *yes, const char *no)
{
    return !strcmp(word, yes) ? 1 : !strcmp(word, no) ? 0 : -1;
}

static int read_scroll(const char *arguments, view_step *step)
{
    int up = either(arguments, "up", "down");
    step->event.type = SYS_EVENT_POINTER;
    step->event.u.pointer.action = SYS_POINTER_SCROLL;
    step->event.u.pointer.button = up ? 1 : -1;
    return up < 0 ? -1 : 0;
}

static int read_position(const char *arguments, view_step *step)
{
    double m[3];
    int end = 0;
    if (sscanf(arguments, "%lf %lf %lf%n", &m[0], &m[1], &m[2], &end) != 3 || arguments[end])
        return -1;
    for (int i = 0; i < 3; i++)
        if (!(m[i] > -METRES_MAX && m[i] < METRES_MAX)) return -1;
    step->event.type = SYS_EVENT_POSITION;
    step->event.u.position.x_wu = (int32_t)(m[0] * FF_WU_PER_METRE);
    step->event.u.position.y_wu = (int32_t)(m[1] * FF_WU_PER_METRE);
    step->event.u.position.z_wu = (int32_t)(m[2] * FF_WU_PER_METRE);
    step->event.u.position.accuracy_wu = 10 * FF_WU_PER_METRE;
    return 0;
}

static int read_accelerometer(const char *arguments, view_step *step)
{
    int x, y, z, end = 0;
    if (sscanf(arguments, "%d %d %d%n", &x, &y, &z, &end) != 3 || arguments[end]) return -1;
    step->event.type = SYS_EVENT_ACCELEROMETER;
    step->event.u.accelerometer.x_mg = x;
    step->event.u.accelerometer.y_mg = y;
    step->event.u.accelerometer.z_mg = z;
    return 0;
}

static int read_battery(const char *arguments, view_step *step)
{
    int low = either(arguments, "low", "ok");
    step->event.type = SYS_EVENT_BATTERY;
    step->event.u.battery.low = low;
    step->event.u.battery.percent = low ? 5 : 80;
    return low < 0 ? -1 : 0;
}

static int read_interruption(const char *arguments, view_step *step)
{
    int begins = either(arguments, "begin", "end");
    step->event.type = SYS_EVENT_INTERRUPTION;
    step->event.u.interruption.begins = begins;
    return begins < 0 ? -1 : 0;
}

static int read_settle(const char *arguments, view_step *step)
{
    step->kind = VIEW_STEP_SETTLE;
    return *arguments ? -1 : 0;
}

static int read_quit(const char *arguments, view_step *step)
{
    step->kind = VIEW_STEP_QUIT;
    return *arguments ? -1 : 0;
}

static int read_screenshot(const char *arguments, view_step *step)
{
    step->kind = VIEW_STEP_SCREENSHOT;
    step->path = *arguments ? strdup(arguments) : NULL;
    return step->path ? 0 : -1;
}

static const struct {
    const char *name;
    reader read;
} commands[] = { { "touch", read_touch },          { "scroll", read_scroll },
                 { "position", read_position },    { "accelerometer", read_accelerometer },
                 { "battery", read_battery },      { "interruption", read_interruption },
                 { "settle", read_settle },        { "quit", read_quit },
                 { "screenshot", read_screenshot } };

/* key, down, up NAME: 1 done, 0 not a key command, -1 unknown key. */
static int read_key(view_script *script, uint32_t frame, const char *command, const char *arguments)
{
    int pressed = !strcmp(command, "key") || !strcmp(command, "down"),
        released = !strcmp(command, "up"), code;
    if (!pressed && !released) return 0;
    if (!(code = key_code(arguments))) return -1;
    if (add_key(script, frame, code, pressed)) return -1;
    if (!strcmp(command, "key") && add_key(script, frame, code, 0)) return -1;
    return 1;
}

static int read_line(view_script *script, char *line)
{
    unsigned frame;
    int end = 0;
    char command[16];
    view_step step = { .kind = VIEW_STEP_EVENT };
    line[strcspn(line, "#\r\n")] = 0;
    for (size_t n = strlen(line); n && (line[n - 1] == ' ' || line[n - 1] == '\t'); n--)
        line[n - 1] = 0;
    if (!line[strspn(line, " \t")]) return 0;
    if (sscanf(line, "%u %15s %n", &frame, command, &end) != 2) return -1;
    if (script->count && frame < script->step[script->count - 1].frame) return -1;
    int key = read_key(script, frame, command, line + end);
    if (key) return key > 0 ? 0 : -1;
    step.frame = frame;
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        if (strcmp(command, commands[i].name)) continue;
        if (commands[i].read(line + end, &step)) return -1;
        if (!add(script, &step)) return 0;
        free(step.path);
        return -1;
    }
    return -1;
}

int view_script_load(view_script *script, const char *path, char *why, size_t why_bytes)
{
    char line[LINE_BYTES], shown[LINE_BYTES];
    FILE *in = fopen(path, "r");
    memset(script, 0, sizeof *script);
    if (!in) {
        snprintf(why, why_bytes, "%s: %s", path, strerror(errno));
        return -1;
    }
    for (unsigned number = 1; fgets(line, sizeof line, in); number++) {
        memcpy(shown, line, sizeof shown);
        if (read_line(script, line) == 0) continue;
        shown[strcspn(shown, "\r\n")] = 0;
        snprintf(why, why_bytes, "%s:%u: not a command: %s", path, number, shown);
        fclose(in);
        view_script_free(script);
        return -1;
    }
    fclose(in);
    return 0;
}

int view_script_keys(view_script *script, const char *keys, char *why, size_t why_bytes)
{
    uint32_t frame = 0;
    memset(script, 0, sizeof *script);
    for (; *keys; keys++) {
        int code = *keys == ' ' ? SYS_KEY_SPACE : *keys > ' ' && *keys < 127 ? *keys : 0;
        if (!code || add_key(script, frame, code, 1) ||
            add_key(script, frame + VIEW_KEY_FRAMES, code, 0)) {
            snprintf(why, why_bytes, "no key for character %d", *keys);
            view_script_free(script);
            return -1;
        }
        frame += VIEW_KEY_FRAMES + 1;
    }
    return 0;
}

void view_script_free(view_script *script)
{
    for (size_t i = 0; i < script->count; i++) free(script->step[i].path);
    free(script->step);
    memset(script, 0, sizeof *script);
}

const view_step *view_script_next(view_script *script, uint32_t frame)
{
    if (script->next == script->count || script->step[script->next].frame > frame) return NULL;
    return &script->step[script->next++];
}
