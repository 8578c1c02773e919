/* Options of programs that hold a client: farfield-fly, farfield-view and farfield-handheld take
 * the same words for them and mean the same. In integers alone: one of the three is the device's.
 *
 * Rows for platform/options/sys_options.h; a program puts them among its own. Quality and balance
 * are kept as text, for reports and titles, and read with the functions below once all is
 * parsed. */
#ifndef SIM_CLIENT_OPTIONS_H
#define SIM_CLIENT_OPTIONS_H

#include "../../client/farfield.h"
#include "../../platform/options/sys_options.h"

typedef const char *sim_quality; /* low, medium, high, paper-low, paper-high, C:DEPTH or px:E */
typedef const char *sim_balance; /* off, server, client or TRIANGLES[,BYTES] */
typedef uint32_t sim_memory;     /* bytes, with K or M; at least ff_client_bytes_min() */
typedef int32_t sim_front;       /* wu, of decimal metres */

extern const char *const sim_panorama_words[]; /* by enum ff_panorama_use */
extern const char *const sim_far_words[];      /* by enum ff_far_use */
extern const sys_option_type sim_quality_option, sim_balance_option, sim_memory_option,
    sim_front_option;

/* Sets all of `quality` but view_wu, for a picture of a size; `triangles`, where they are not 0,
 * stand for the text's limit. 0, or SYS_NOT_ONE. */
int sim_quality_read(const char *text, uint32_t triangles, const sys_size *size,
                     ff_quality *quality);
int sim_balance_read(const char *text, ff_balance_desc *balance);
/* Both, of texts that their options took; *quality_text NULL becomes the default. */
void sim_client_read(const char **quality_text, uint32_t triangles, const sys_size *size,
                     const char *balance_text, ff_quality *quality, ff_balance_desc *balance);

/* What draws far ground where it is not said, SYS_UNSET: sets where they pay, or, for who names
 * panoramas or wants the server to draw all it can, those. */
void sim_far_read(const ff_balance_desc *balance, sys_word *use_far, sys_word *use_panorama);

#define SIM_SPEED_KMH_MAX 100000
#define SIM_HEIGHT_M_MAX  1000000
#define SIM_FOV_MIN       0.1
#define SIM_FOV_MAX       170.0
#define SIM_FRAMES_MAX    1000000000
#define SIM_BUDGET_MAX    1000000000u

/* clang-format off */
#define SIM_CLIENT_OPTIONS(OPTION, memory, memory_help) \
    OPTION(sim_quality, quality_text, "quality", "Q", NULL, SYS_ANY, \
           "how fine the ground is drawn; default medium; with a budget of triangles (--balance) px:1. low, medium, high: 4, 2 and 1 pixels of error, and at " \
           "most a triangle for 24, 14 and 4 pixels. paper-low, paper-high: Hybrid's, 3:4 and " \
           "9:8, their levels counted from a tile's root (farfield-bake --tile-log2 10). These and the others: at most a triangle for 2 pixels") \
    OPTION(sys_whole, triangles, "triangles", "N", NULL, \
           SYS_WHOLE(FF_TRIANGLES_MIN, SIM_BUDGET_MAX, ""), \
           "the most triangles of ground in a picture: where --quality asks for more, all of it " \
           "is drawn as much coarser as that takes, and in the end less far; default: what --quality says") \
    OPTION(sim_balance, balance_text, "balance", "SPEC", "off", SYS_ANY, \
           "budgets; what --quality and --panorama say is the finest. No picture has more " \
           "triangles than the first number (0: as many as --quality allows). The second: bytes " \
           "that may come a second (0: at most 80 % of what the link carries); pixels of error, " \
           "or C, and the panoramas' error give way to it. client: as set, without panoramas; " \
           "server: as few triangles as can be, up to the nearest back plane; off: all as set") \
    OPTION(sim_memory, memory_bytes, "memory", "BYTES", memory, SYS_ANY, memory_help)
#define SIM_PANORAMA_OPTION(OPTION, help) \
    OPTION(sys_word, use_panorama, "panorama", "USE", NULL, SYS_WORDS(sim_panorama_words), help "; default: off; auto: where that is cheaper for the error allowed")
#define SIM_FAR_OPTIONS(OPTION) \
    OPTION(sys_word, use_far, "far", "USE", NULL, SYS_WORDS(sim_far_words), \
           "far ground as a coarse tree with fins, the outlines of ridges, and paint on them, taken by " \
           "the server; no panoramas then. auto: where that pays, as much as the link carries; default: auto, " \
           "or off where --panorama is given or the server draws all it can (--balance server)") \
    OPTION(sim_front, far_front_wu, "far-front", "M", NULL, SYS_ANY, \
           "where that begins; default 7500") \
    OPTION(sys_whole, far_coarse, "far-coarse", "N", NULL, SYS_WHOLE(1, FF_FAR_COARSE_MAX, ""), \
           "how many times as wrong as --quality allows the tree may be there; default 4") \
    OPTION(sys_whole, far_shift, "far-shift", "N", "0", SYS_WHOLE(0, FF_FAR_SHIFT_MAX, ""), \
           "texels of paint are 2^N pixels wide") \
    OPTION(sys_whole, far_quality, "far-quality", "Q", NULL, SYS_WHOLE(1, 100, ""), \
           "quality of the paint, as of pictures; default 80, wider than 320 pixels 84") \
    OPTION(sys_whole, far_tolerance, "far-tolerance", "N", NULL, SYS_WHOLE(1, 64, ""), \
           "quarter pixels that a fin may be off; default 2")
/* Of a struct that has the fields of those rows. */
#define SIM_FAR_DESC(options) \
    (ff_far_desc) { \
        .enabled = (uint8_t)(options)->use_far, \
        .front_wu = (options)->far_front_wu, \
        .coarse = (uint8_t)(options)->far_coarse, .paint_shift = (uint8_t)(options)->far_shift, \
        .quality = (uint8_t)(options)->far_quality, \
        .tolerance_q2 = (uint8_t)(options)->far_tolerance \
    }
#define SIM_SIZE_OPTION(OPTION, help) \
    OPTION(sys_size, size, "size", "WxH", "240x320", SYS_WHOLE(16, FF_PICTURE_SIDE_MAX, "pixels"), \
           help)
#define SIM_FOV_OPTION(OPTION) \
    OPTION(sys_real, fov_degrees, "fov", "DEGREES", "60", SYS_REAL(SIM_FOV_MIN, SIM_FOV_MAX, "degrees"), \
           "field of view across the width")
#define SIM_PLAIN_ARRAYS_OPTION(OPTION) \
    OPTION(sys_flag, plain_arrays, "plain-arrays", NULL, NULL, SYS_ANY, "no vertex buffers")
/* FF_SHOW_MODES(SIM_SHOW_ROW) stands for `sys_bits show`; ROW is the program's. */
#define SIM_SHOW_ROW(NAME, option, key, name, help) \
    ROW(sys_bits, show, option, NULL, NULL, SYS_BIT(FF_SHOW_INDEX_##NAME), help)
/* clang-format on */

#endif
