#include "sim_client_options.h"

#include <stdio.h>
#include <string.h>

#define LEAST_Q8   3 /* 0.01 */
#define MEMORY_MAX (4095u << 20)

/* ---- quality ---- */

static int q8_at(const char **text, uint64_t most, int32_t *q8)
{
    uint64_t value;
    if (sys_decimal(text, 256, most * 256, &value) || value < LEAST_Q8) return SYS_NOT_ONE;
    *q8 = (int32_t)value;
    return 0;
}

/* What the words stand for: a measure, and pixels of the picture for each triangle at most; 0: as
 * many triangles as a client draws at most by itself. */
static const struct {
    const char *word, *measure;
    unsigned pixels;
} preset[] = { { "low", "px:4", 24 },
               { "medium", "px:2", FF_QUALITY_DEFAULT_PIXELS },
               { "high", "px:1", 4 },
               { "paper-low", "3:4", 0 },
               { "paper-high", "9:8", 0 } };
FF_STATIC_ASSERT(FF_QUALITY_DEFAULT_PX == 2 && FF_QUALITY_BUDGET_PX == 1); /* medium, px:1 */

int sim_quality_read(const char *text, uint32_t triangles, const sys_size *size,
                     ff_quality *quality)
{
    uint64_t depth = 0;
    ff_quality read = { .sigma_q8 = 320, .view_wu = quality->view_wu };
    for (size_t i = 0; i < sizeof preset / sizeof *preset; i++) {
        if (strcmp(text, preset[i].word)) continue;
        text = preset[i].measure;
        if (preset[i].pixels)
            read.triangles_max = (uint32_t)size->width * size->height / preset[i].pixels;
        break;
    }
    if (triangles) read.triangles_max = triangles;
    if (!strncmp(text, "px:", 3)) {
        text += 3;
        read.measure = FF_MEASURE_PIXELS;
        if (q8_at(&text, FF_QUALITY_ERROR_PX_MAX, &read.error_px_q8)) return SYS_NOT_ONE;
    } else {
        read.measure = FF_MEASURE_DISTANCE;
        if (q8_at(&text, FF_QUALITY_C_MAX, &read.c_q8) || *text++ != ':' ||
            sys_whole_at(&text, 0, FF_QUALITY_DEPTH_MAX, &depth))
            return SYS_NOT_ONE;
        read.depth_max = (uint8_t)depth;
    }
    *quality = read;
    return *text ? SYS_NOT_ONE : 0;
}

static int quality_range(const sys_option *option, char *text, size_t room)
{
    (void)option;
    return snprintf(
        text, room,
        "low, medium, high, paper-low, paper-high, C:DEPTH with C 0.01 to %d and DEPTH 0 to %d (0: all levels), or "
        "px:E for E pixels of error, 0.01 to %d",
        FF_QUALITY_C_MAX, FF_QUALITY_DEPTH_MAX, FF_QUALITY_ERROR_PX_MAX);
}

static int take_quality(const sys_option *option, const char *text, void *field)
{
    ff_quality quality = { 0 };
    (void)option;
    *(sim_quality *)field = text;
    return sim_quality_read(text, 0, &(sys_size){ 1, 1 }, &quality);
}

/* ---- balance ---- */

int sim_balance_read(const char *text, ff_balance_desc *balance)
{
    static const char *const word[] = { "off", "server", "client", NULL };
    static const enum ff_balance_mode mode[] = { FF_BALANCE_OFF, FF_BALANCE_ALL_SERVER,
                                                 FF_BALANCE_ALL_CLIENT };
    uint64_t triangles, bytes_s = 0;
    int index = sys_word_index(word, text);
    *balance = (ff_balance_desc){ .mode = index < 0 ? FF_BALANCE_ON : mode[index] };
    if (index >= 0) return 0;
    if (sys_whole_at(&text, 0, SIM_BUDGET_MAX, &triangles)) return SYS_NOT_ONE;
    if (*text == ',') {
        text++;
        if (sys_whole_at(&text, 0, SIM_BUDGET_MAX, &bytes_s)) return SYS_NOT_ONE;
    }
    balance->frame_budget = (uint32_t)triangles;
    balance->link_bytes_s = (uint32_t)bytes_s;
    return *text ? SYS_NOT_ONE : 0;
}

void sim_client_read(const char **quality_text, uint32_t triangles, const sys_size *size,
                     const char *balance_text, ff_quality *quality, ff_balance_desc *balance)
{
    (void)sim_balance_read(balance_text, balance);
    if (!*quality_text) *quality_text = balance->frame_budget ? "px:1" : "medium";
    (void)sim_quality_read(*quality_text, triangles, size, quality);
}

static int balance_range(const sys_option *option, char *text, size_t room)
{
    (void)option;
    return snprintf(text, room, "off, server, client, or TRIANGLES[,BYTES], each 0 to %u",
                    SIM_BUDGET_MAX);
}

static int take_balance(const sys_option *option, const char *text, void *field)
{
    ff_balance_desc balance;
    (void)option;
    *(sim_balance *)field = text;
    return sim_balance_read(text, &balance);
}

/* ---- memory ---- */

static int memory_range(const sys_option *option, char *text, size_t room)
{
    (void)option;
    return snprintf(text, room, "bytes, with K or M: %uK to %uM",
                    (unsigned)((ff_client_bytes_min() + 1023) >> 10), MEMORY_MAX >> 20);
}

static int take_memory(const sys_option *option, const char *text, void *field)
{
    uint64_t bytes;
    char unit = *text ? text[strlen(text) - 1] : '0';
    uint32_t scale = unit == 'M' ? 1u << 20 : unit == 'K' ? 1u << 10 : 1;
    (void)option;
    if (sys_decimal(&text, scale, MEMORY_MAX, &bytes) || strlen(text) != (scale != 1) ||
        bytes < ff_client_bytes_min())
        return SYS_NOT_ONE;
    *(sim_memory *)field = (uint32_t)bytes;
    return 0;
}

/* ---- who draws far ground ---- */

void sim_far_read(const ff_balance_desc *balance, sys_word *use_far, sys_word *use_panorama)
{
    int by_server = balance->mode == FF_BALANCE_ALL_SERVER,
        named = by_server || *use_panorama != SYS_UNSET;
    if (*use_panorama == SYS_UNSET)
        *use_panorama = by_server && *use_far == SYS_UNSET ? FF_PANORAMA_ON : FF_PANORAMA_OFF;
    if (*use_far == SYS_UNSET) *use_far = named ? FF_FAR_OFF : FF_FAR_AUTO;
}

/* ---- where far sets begin ---- */

static int front_range(const sys_option *option, char *text, size_t room)
{
    (void)option;
    return snprintf(text, room, "1 to %d m", FF_PANORAMA_BACK_WU_MAX / FF_WU_PER_METRE);
}

static int take_front(const sys_option *option, const char *text, void *field)
{
    uint64_t wu;
    (void)option;
    if (sys_decimal(&text, FF_WU_PER_METRE, FF_PANORAMA_BACK_WU_MAX, &wu) || *text ||
        wu < FF_WU_PER_METRE)
        return SYS_NOT_ONE;
    *(sim_front *)field = (sim_front)wu;
    return 0;
}

const char *const sim_far_words[] = { "off", "fins", "paint", "auto", NULL };
const char *const sim_panorama_words[] = { "off", "on", "auto", NULL };
const sys_option_type sim_quality_option = { "", quality_range, take_quality },
                      sim_balance_option = { "", balance_range, take_balance },
                      sim_memory_option = { "a number of ", memory_range, take_memory },
                      sim_front_option = { "", front_range, take_front };
