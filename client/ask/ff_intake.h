/* Payloads to new data: entropy decoding of heights and JPEG decoding of images, on the worker's
 * side. Used by the stream (bytes from a link) and by the local pack alike. */
#ifndef FF_INTAKE_H
#define FF_INTAKE_H

#include "ff_new_data.h"

typedef struct ff_intake {
    ff_requests *requests;
    ff_new_data *news;
    ff_decoder *decoder; /* common to all intakes of one worker: turned to the ground at hand */
    /* the grounds of who answers, their tiles as its messages number them */
    ff_terrain_info info[FF_WELCOME_GROUNDS];
    uint8_t ground_count, told_count; /* those the client has; all that it was told of */
    uint8_t *rgb;                     /* scratch of one image, RGB888 */
    size_t rgb_bytes;
    uint16_t *columns; /* scratch: tops and bottoms of a face's columns, 2 * face_size_max */
    uint16_t face_size_max;
    uint8_t source; /* whose answers they are, of several */
} ff_intake;

/* The number of the ground that a key is of, or -1. */
int ff_intake_ground(const ff_intake *intake, ff_key key);
/* Puts an answer on the list, decoded as the request's kind says, and moves the request on when it
 * is the last. `bytes`: of the whole message; a payload counts without its head. FF_OK (an
 * undecodable answer too: the item says so), or FF_ERR_AGAIN: the list is full, nothing happened,
 * try later. */
int ff_intake_answer(ff_intake *intake, const ff_request *request, const ff_message *answer,
                     uint32_t bytes);
/* The same for a root or refinement among the answers to a view; its end is an answer as above. */
int ff_intake_part(ff_intake *intake, const ff_request *request, enum ff_kind kind, ff_key key,
                   const ff_part *part);
/* No answer will come: FF_ERR_CLOSED stands for cancelled. */
int ff_intake_failed(ff_intake *intake, const ff_request *request, int error);

#endif
