/* Messages between client and server over one long-lived byte stream (Hybrid, section 8.2, figure
 * 24).
 *
 * Every message: type (1 byte), body length (LEB128, 1..3 bytes), body. Numbers are little-endian;
 * `id` is the client's request number, unique among its unanswered requests. Every request gets
 * exactly one final answer (NODE, TEXTURE, FACE with FF_FACE_LAST, or FAILED), unless it was
 * cancelled, when the answer may be CANCELLED instead. Pure bytes: no sockets here.
 */
#ifndef FF_MESSAGE_H
#define FF_MESSAGE_H

#include "../codec/ff_codec.h"

#define FF_PROTOCOL_VERSION   2
#define FF_MESSAGE_BODY_MAX   (1u << 18) /* a longer length is a protocol error */
#define FF_MESSAGE_HEADER_MAX 4
#define FF_REQUEST_BYTES_MAX  48 /* any client message but HELLO fits */
#define FF_FACE_COUNT         6
#define FF_FACE_SIZE_MAX      1024

enum ff_message_type {
    /* client to server */
    FF_MSG_HELLO = 1,        /* ff_hello */
    FF_MSG_GET_NODE = 2,     /* ff_get: root (level 0, FF_GET_ROOT) or the refinement of a node */
    FF_MSG_GET_TEXTURE = 3,  /* ff_get */
    FF_MSG_GET_PANORAMA = 4, /* ff_get_panorama */
    FF_MSG_CANCEL = 5,       /* ff_cancel: the answer is no longer wanted */
    FF_MSG_PING = 6,         /* ff_ping */
    /* server to client */
    FF_MSG_WELCOME = 65,   /* ff_welcome: the terrain */
    FF_MSG_NODE = 66,      /* ff_data: payload of ff_decode_root / ff_decode_refinement */
    FF_MSG_TEXTURE = 67,   /* ff_data: a bare JPEG (SPEC.md) */
    FF_MSG_FACE = 68,      /* ff_face: one face of a panorama */
    FF_MSG_FAILED = 69,    /* ff_failed: this request has no answer */
    FF_MSG_CANCELLED = 70, /* ff_cancel */
    FF_MSG_PONG = 71,      /* ff_ping */
    FF_MSG_GOODBYE = 72    /* ff_failed with id 0: the server closes, and says why */
};

typedef struct ff_hello {
    uint32_t version;
    uint32_t known_checksum; /* of the pack in the client's cache; 0: none */
} ff_hello;
enum ff_get_what { FF_GET_ROOT = 0, FF_GET_REFINEMENT = 1 };
typedef struct ff_get {
    uint16_t id;
    uint8_t what; /* enum ff_get_what; textures: 0 */
    ff_key key;
} ff_get;

/* The faces of a cube aligned with the world, each named for the direction it looks in. Images of
 * the four level faces have the sky at their top; FACE_UP's has south there, FACE_DOWN's north. */
enum ff_face_name {
    FF_FACE_NORTH,
    FF_FACE_EAST,
    FF_FACE_SOUTH,
    FF_FACE_WEST,
    FF_FACE_UP,
    FF_FACE_DOWN
};

typedef struct ff_get_panorama {
    uint16_t id;
    int32_t position_wu[3]; /* O (Hybrid, figure 14): the point from which the panorama is drawn */
    /* Hybrid's z_front_s: ground nearer to O (in its largest coordinate difference) is not drawn */
    int32_t front_wu;
    int32_t back_wu;             /* Hybrid's z_back_s: nor is ground farther from O */
    uint16_t face_size;          /* texels a side, 16..FF_FACE_SIZE_MAX */
    uint8_t quality;             /* JPEG quality 1..100 */
    uint8_t face_count;          /* 1..6 */
    uint8_t face[FF_FACE_COUNT]; /* enum ff_face_name, in the order in which they are to come */
} ff_get_panorama;

typedef struct ff_cancel {
    uint16_t id;
} ff_cancel;
typedef struct ff_ping {
    uint32_t stamp;
} ff_ping;
typedef struct ff_welcome {
    uint32_t version;
    ff_terrain_info info;
} ff_welcome;
typedef struct ff_data {
    uint16_t id;
    const uint8_t *bytes; /* inside the message, not copied */
    uint32_t byte_count;
} ff_data;
typedef struct ff_failed {
    uint16_t id;
    int8_t error; /* enum ff_error */
} ff_failed;

enum ff_face_flags {
    FF_FACE_EMPTY = 1, /* no far ground in it: no image */
    FF_FACE_LAST = 2   /* the last face of its request */
};

/* A face carries only the rows that show far ground: rows top_row .. top_row+row_count-1 of
 * face_size. Within them column c shows ground in rows column_top[c] .. column_bottom[c]-1
 * (relative to top_row), else nothing: the sky is the client's own. */
typedef struct ff_face {
    uint16_t id;
    uint8_t face;  /* enum ff_face_name */
    uint8_t flags; /* enum ff_face_flags */
    uint16_t face_size;
    uint16_t top_row, row_count;
    const uint8_t *columns; /* packed column spans, see ff_face_columns_encode */
    uint32_t columns_bytes;
    const uint8_t *image; /* bare JPEG of face_size by row_count texels */
    uint32_t image_bytes;
} ff_face;

/* Packed spans: `top` and `bottom` have `count` (face_size) entries, each 0..row_count. Encode:
 * bytes written, or FF_ERR_FULL (capacity 4*count+8 always fits). Decode: FF_OK or TRUNCATED,
 * RANGE; top <= bottom is guaranteed. */
int ff_face_columns_encode(const uint16_t *top, const uint16_t *bottom, uint32_t count,
                           uint8_t *out, size_t capacity);
int ff_face_columns_decode(const uint8_t *bytes, size_t byte_count, uint32_t count,
                           uint32_t row_count, uint16_t *top, uint16_t *bottom);

/* One received or to-be-sent message, decoded. */
typedef struct ff_message {
    enum ff_message_type type;
    union {
        ff_hello hello;
        ff_get get;
        ff_get_panorama panorama;
        ff_cancel cancel;
        ff_ping ping;
        ff_welcome welcome;
        ff_data data;
        ff_face face;
        ff_failed failed;
    } u;
} ff_message;

/* Bytes written to `out`, or FF_ERR_FULL, FF_ERR_RANGE. */
int ff_message_encode(const ff_message *message, uint8_t *out, size_t capacity);
/* Most bytes `message` can need, header included. */
size_t ff_message_bytes_max(const ff_message *message);

/* Takes one message off the front of `bytes`. Returns bytes consumed (> 0); 0 when more bytes are
 * needed, or a negative error (FORMAT: unknown type; RANGE; TRUNCATED: body shorter than its
 * fields), after which the stream is lost and must be closed. Pointers in `out` refer into `bytes`.
 * All fields are range-checked here. */
int ff_message_decode(const uint8_t *bytes, size_t byte_count, ff_message *out);

#endif
