/* A tape: all that came to a client during a flight, call by call, so that another build (another
 * machine, another back end) can be flown through the very same flight without server and link.
 * farfield-fly records, farfield-handheld plays.
 *
 * Little endian. "fftape 5", then SIM_TAPE_HEAD signed 32-bit numbers (sim_tape_head), then
 * records, each begun by a letter:
 *   W time:i64               ff_client_work
 *   U time:i64 x y z yaw pitch roll focal:i32 flying:u8
 *                            ff_client_update; flying 0: the flight is still settling
 *   R value:i32 bytes...     what the stream's recv answered, inside the last W; recv calls that
 *                            brought nothing are not recorded
 *   S value:i32 hash:u32     what send answered, and FNV-1a of the bytes that send was offered
 *   C value:i32              what reconnect answered
 *   L count:i32 name...      ff_client_set_layer by a name of so many bytes; -1: none is shown
 *   E geometry:u64 requests:u64
 *                            the end: the client's two hashes
 */
#ifndef SIM_TAPE_H
#define SIM_TAPE_H

#include "../../client/farfield.h"

#include <stdio.h>

/* What the recorded client was given; the player gives the same to its client. */
typedef struct sim_tape_head {
    uint32_t memory_bytes;
    uint16_t width, height;
    ff_quality quality;
    ff_panorama_desc panorama;
    ff_far_desc far;
    enum ff_hidden hidden;
    uint8_t no_views;
    int32_t velocity_wu_s[2];
    uint32_t first_answer_ms;
} sim_tape_head;

/* ---- recording ---- */
typedef struct sim_tape_recorder {
    FILE *file;
    sys_stream inner;
} sim_tape_recorder;

/* Starts the tape; `stream` records from here on (the recorder must outlive it). FF_OK or
 * FF_ERR_SYSTEM. */
int sim_tape_record(sim_tape_recorder *recorder, const char *path, const sim_tape_head *head,
                    sys_stream *stream);
void sim_tape_work(sim_tape_recorder *recorder, int64_t now_us);
void sim_tape_frame(sim_tape_recorder *recorder, int64_t now_us, const c3d_camera *camera,
                    int flying);
/* The name is given to ff_client_set_layer. */
void sim_tape_layer(sim_tape_recorder *recorder, const char *name);
/* Ends and closes the tape: FF_OK, or FF_ERR_SYSTEM when not all of it could be written. */
int sim_tape_finish(sim_tape_recorder *recorder, uint64_t geometry_hash, uint64_t request_hash);

/* ---- playing ---- */
enum sim_tape_kind { SIM_TAPE_WORK, SIM_TAPE_FRAME, SIM_TAPE_LAYER, SIM_TAPE_END };

typedef struct sim_tape_step {
    enum sim_tape_kind kind;
    int64_t now_us;
    int flying;                           /* of a frame */
    c3d_camera camera;                    /* of a frame */
    uint64_t geometry_hash, request_hash; /* of the end */
    char layer[FF_LAYER_NAME_MAX + 1];    /* of a layer */
    int shows_none;                       /* of a layer: no images are shown */
} sim_tape_step;

typedef struct sim_tape_player {
    const uint8_t *at, *end;
    uint32_t left; /* bytes of the R record begun */
    int differs;   /* 1: the client did not do what was recorded */
    sim_tape_head head;
} sim_tape_player;

/* Opens a tape in memory, which must outlive the player; `stream` plays it. FF_OK or
 * FF_ERR_FORMAT. */
int sim_tape_open(sim_tape_player *player, const void *bytes, uint64_t count, sys_stream *stream);
/* The next step: FF_OK, or FF_ERR_FORMAT when the tape is damaged or the client differs from the
 * one recorded. */
int sim_tape_next(sim_tape_player *player, sim_tape_step *step);

#endif
