/* Messages between client and server over one long-lived byte stream (Hybrid, section 8.2, figure
 * 24).
 *
 * A message: type (1 byte), body length (LEB128, 1..3 bytes), body. Numbers are little-endian.
 * Those that come most often have shorter forms (ff_message_short.c). Requests have a number, `id`,
 * not 0 and unique among the client's unanswered ones; those for what belongs to one node have none
 * (0): they are answered in the order in which they were made. Parts of a view and sectors of far
 * ground do without their request's: they are of the oldest such request. Every request gets
 * exactly one final answer (its kind's, with FF_FACE_LAST where there are several, or FAILED),
 * unless it was cancelled, when the answer may be CANCELLED instead. Pure bytes: no sockets here.
 */
#ifndef FF_MESSAGE_H
#define FF_MESSAGE_H

#include "../codec/ff_codec.h"
#include "../far/ff_far.h"
#include "../ff_about.h"
#include "../ff_kind.h"

#define FF_PROTOCOL_VERSION   11
#define FF_MESSAGE_BODY_MAX   (1u << 18) /* a longer length is a protocol error */
#define FF_MESSAGE_HEADER_MAX 4
#define FF_REQUEST_BYTES_MAX  480 /* any client message but CAPS fits */
#define FF_SHORT_BYTES_MAX    60  /* any message without a list, a payload, an image or keys fits */
#define FF_CAPS_BYTES_MAX     512 /* of the list in CAPS */
#define FF_WELCOME_BYTES_MAX  1024 /* of that in WELCOME */
#define FF_FACE_COUNT         6
#define FF_FACE_SIZE_MAX      1024

/* A length of 3 bytes reaches the longest body, and one of 2 does not. */
FF_STATIC_ASSERT(FF_MESSAGE_BODY_MAX >> 7 * (FF_MESSAGE_HEADER_MAX - 1) == 0 &&
                 FF_MESSAGE_BODY_MAX >> 7 * (FF_MESSAGE_HEADER_MAX - 2) != 0);
FF_STATIC_ASSERT(2 + FF_PAYLOAD_BYTES_MAX <= FF_MESSAGE_BODY_MAX);

/* Messages about the link itself: X(name, type, who sends it). Those that ask for things, and those
 * that answer, stand in ff_kind.h. */
/* clang-format off */
#define FF_MESSAGE_LIST(X) \
    X(HELLO,      1, CLIENT) /* ff_hello */ \
    X(CANCEL,     5, CLIENT) /* ff_cancel: the answer is no longer wanted */ \
    X(PING,       6, CLIENT) /* ff_ping */ \
    X(CAPS,       7, CLIENT) /* ff_list: what the client can, FF_CAPS_LIST */ \
    X(LAYER,     11, CLIENT) /* ff_get_layer: whose images are asked for from here on */ \
    X(GET_ABOUT,  8, CLIENT) /* ff_get_about: what does the pack say of itself */ \
    X(WELCOME,   65, SERVER) /* ff_welcome: the terrain */ \
    X(FAILED,    69, SERVER) /* ff_failed: this request has no answer */ \
    X(CANCELLED, 70, SERVER) /* ff_cancel */ \
    X(PONG,      71, SERVER) /* ff_ping */ \
    X(GOODBYE,   72, SERVER) /* ff_failed with id 0: the server closes, and says why */ \
    X(ABOUT,     73, SERVER) /* ff_list: FF_ABOUT_LIST */ \
    X(ROOTS,     74, SERVER) /* ff_roots: which a view that named nothing brings */ \
    X(EDGE,      76, SERVER) /* ff_edge: which of a view's edge are refined in the answer */

/* Lists that open a connection: X(ENTRY, type, least, most bytes). Types that nobody sends yet are
 * given, so that who begins to send them need not raise the version. */
#define FF_CAPS_LIST(X) \
    X(CODECS,   1, 1, 16)  /* of heights that the client decodes, u8 each */ \
    X(DEVICE,   2, 1, 64)  /* which device it is, any bytes */ \
    X(TOKEN,    3, 1, 255) /* what it may have, any bytes */ \
    X(SCREEN,   4, 4, 4)   /* u16 width, height */ \
    X(BUDGETS,  5, 8, 8)   /* u32 bytes a second, u32 bytes of memory; 0: not told */ \
    X(FEATURES, 6, 4, 4)   /* u32 bits: 0 images, 1 panoramas */ \
    X(REACH,    7, 4, 4)   /* u32: ground farther than this along an axis, wu, is not looked at */
#define FF_WELCOME_GROUNDS 7 /* that a server has, at most */
#define FF_TERRAIN_SET     ((FF_TERRAIN_BYTES + 7) / 8) /* bytes of a bit for each of its own */
#define FF_WELCOME_LIST(X) \
    X(TERRAIN,  1, FF_TERRAIN_SET, FF_TERRAIN_SET + FF_TERRAIN_BYTES) /* needed; without its zeros */ \
    X(PIXELS,   2, 6, 6) /* u16 face_size at most, u32 pixels of faces in a minute */ \
    X(REQUESTS, 3, 2, 2) /* u16 unanswered at once */ \
    X(BYTES,    4, 4, 4) /* u32 bytes a second */ \
    X(WHOLE,    5, 4, 4 * FF_WELCOME_GROUNDS) /* u32 of each: checksum of the whole that it is of */ \
    X(TERRAINS, 6, FF_TERRAIN_BYTES, FF_TERRAIN_BYTES * (FF_WELCOME_GROUNDS - 1)) /* more terrains */ \
    X(ENTRY,    7, 1, FF_WELCOME_GROUNDS) /* u8 of each: levels above its tiles that are left out */ \
    X(LACKS,    8, 4, 4) /* u32 bits of FF_LACKS_: what nobody draws here */ \
    X(IMAGES,   9, 1, FF_WELCOME_GROUNDS) /* u8 of each: ff_terrain_info.images_whole */ \
    X(LAYERS,  10, 2, 1023) /* ff_layers.h, levels of each ground; one without a name is not told */
/* clang-format on */

enum ff_caps_entry {
#define X(entry, type, least, most) FF_CAPS_##entry = type,
    FF_CAPS_LIST(X)
#undef X
};
enum { FF_LACKS_PANORAMAS = 2, FF_LACKS_FAR = 4 };
enum ff_welcome_entry {
#define X(entry, type, least, most) FF_WELCOME_##entry = type,
    FF_WELCOME_LIST(X)
#undef X
};

enum ff_message_type {
#define X(name, type, sender) FF_MSG_##name = type,
    FF_MESSAGE_LIST(X)
#undef X
    /* Each stands for all types of its sort, and the message says of which kind it is. Neither
     * is a byte. */
    FF_MSG_GET = 256,
    FF_MSG_ANSWER
};
FF_STATIC_ASSERT(FF_MSG_GET > UINT8_MAX);

typedef struct ff_hello {
    uint32_t version;
    uint32_t known_checksum; /* of the pack in the client's cache; 0: none */
} ff_hello;
typedef struct ff_get {
    ff_key key;    /* of a root: level 0 */
    uint8_t sides; /* of a refinement: bit ff_side: the client has that side, it may be left out */
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
FF_STATIC_ASSERT(FF_FACE_DOWN + 1 == FF_FACE_COUNT);

typedef struct ff_get_panorama {
    uint16_t id;
    int32_t position_wu[3]; /* O (Hybrid, figure 14): the point from which the panorama is drawn */
    /* Hybrid's z_front_s: ground nearer to O (in its largest coordinate difference) is not drawn */
    int32_t front_wu;
    int32_t back_wu;             /* Hybrid's z_back_s: nor is ground farther from O */
    uint16_t face_size;          /* texels a side, 16..FF_FACE_SIZE_MAX */
    uint8_t quality;             /* of the paint, 1..100 */
    uint8_t face_count;          /* 1..6 */
    uint8_t face[FF_FACE_COUNT]; /* enum ff_face_name, in the order in which they are to come */
    uint8_t layer;               /* of its images; not in the message: LAYER told it */
} ff_get_panorama;

/* Far ground as fins and paint, taken at one point O: the sectors of a set (protocol/far/ff_far.h
 * says what they are made of and how places stand in them). Nothing of it travels that no viewer in
 * the region round O can see. The region: from behind_m behind O to ahead_m ahead of it along
 * `heading`, aside_m to either side, at heights from low_m to high_m above O. O itself, the eye of
 * the picture, may lie above all of it. */
typedef struct ff_get_far {
    uint16_t id;
    int32_t position_wu[3]; /* O */
    int32_t front_wu;       /* ground nearer to O (in x or y, whichever differs more) is left out */
    uint16_t heading;       /* 1/65536 turn, 0 north, clockwise */
    uint16_t behind_m, ahead_m, aside_m;
    int16_t low_m, high_m; /* heights above O, low_m <= high_m: both may be below it */
    uint16_t focal;        /* texels a unit of tangent: FF_FAR_FOCAL_MIN..FF_FAR_FOCAL_MAX */
    uint16_t down;         /* texels below O's horizon that anybody looks at, 1..2 * FOCAL_MAX */
    uint8_t paint_shift;   /* texels of the paint are 2^this as large, 0..3 */
    uint8_t quality;       /* of the paint, 1..100; 0: no paint */
    uint8_t tolerance_q2;  /* quarter texels that a fin may be off; 0: no fins */
    uint8_t sector_count;  /* 1..FF_FAR_SECTORS */
    uint8_t sector[FF_FAR_SECTORS]; /* all different, in the order in which they are to come */
    uint8_t layer;                  /* of its images; not in the message: LAYER told it */
} ff_get_far;

/* What a request has besides its key, of the kinds whose key is a number of the client's own. */
typedef union ff_ask {
    uint16_t id;
    ff_get_panorama panorama; /* FF_ASKS_PANORAMA */
    ff_get_far far;           /* FF_ASKS_FAR */
} ff_ask;

/* What is missing for a view: the server answers with these roots and refinements, and with all
 * below them that the view needs, as a client's own selection finds it (client/terrain/ff_tree.h):
 * one round trip instead of one for each level. A client has at most one such request out. */
#define FF_VIEW_KEYS_MAX   16
#define FF_VIEW_EDGE_MAX   24
#define FF_VIEW_SIDE_MAX   4096
#define FF_VIEW_COARSE_MAX 16
enum ff_view_measure { FF_VIEW_BY_DISTANCE, FF_VIEW_BY_PIXELS };

typedef struct ff_get_view {
    uint16_t id;
    uint16_t yaw, pitch, roll; /* 1/65536 turn, as in common3d/c3d.h */
    int32_t position_wu[3];    /* of the camera, in world axes */
    int32_t focal_q8;          /* 256.. */
    uint16_t width, height;    /* of the picture, pixels, 1..FF_VIEW_SIDE_MAX */
    uint8_t measure;           /* enum ff_view_measure: what `allowed_q8` is */
    uint8_t depth_max;         /* levels used; 0: all */
    int32_t allowed_q8;        /* C of Hybrid eq. 3, or pixels of error; 1.. */
    int32_t reach_wu;          /* ground farther than this is not drawn; 1.. */
    /* ground farther than fine_wu along x or y may be `coarse` times as wrong, 1..16 */
    int32_t fine_wu;
    uint8_t coarse;
    uint32_t triangles_max; /* in the picture; 0: any number */
    uint32_t bytes_max;     /* of payloads, all answers together; the last may pass it */
    uint16_t roots;         /* bit i: below[i] is a root that is missing, else a node whose
                             * refinement is */
    uint8_t count;          /* of below: 0: all that the view needs; ..FF_VIEW_KEYS_MAX */
    ff_key below[FF_VIEW_KEYS_MAX];
    /* Nodes that the client has, and lacks all below: they are refined where the view needs it,
     * beside what is named. */
    uint8_t edge_count; /* 0 where nothing is named */
    ff_key edge[FF_VIEW_EDGE_MAX];
} ff_get_view;

/* 1 when an answer to the request may bring this root or refinement. */
int ff_view_covers(const ff_get_view *view, enum ff_kind kind, ff_key key);
/* Bit i: this is what view->below[i] names. */
uint32_t ff_view_names(const ff_get_view *view, enum ff_kind kind, ff_key key);

/* One answer to it, a root or a refinement, or word that some come later. Of which node stands in
 * none of them: ff_parts.h finds it. An answer has FF_PARTS_MAX at most. */
#define FF_PARTS_MAX       512
#define FF_PARTS_LATER_MAX 16

typedef struct ff_part {
    /* bit q: the refinement of child q comes later in this answer; of a root: bit 0, its own */
    uint8_t below;
    const uint8_t *bytes; /* inside the message, not copied */
    uint32_t byte_count;  /* 0: it cannot be read, and nothing below it comes */
    uint8_t later; /* not 0: it is no part, but so many of the next ones come behind all others */
} ff_part;

/* The tiles whose roots come first, where the request named nothing: a varint each, inside the
 * message, FF_PARTS_MAX at most. */
typedef struct ff_roots {
    const uint8_t *bytes;
    uint32_t byte_count;
} ff_roots;

/* Comes first, where the request has an edge: bit i: what refines view->edge[i] comes. */
typedef struct ff_edge {
    uint32_t needed;
} ff_edge;

typedef struct ff_cancel {
    uint16_t id;
} ff_cancel;
typedef struct ff_ping {
    uint32_t stamp;
} ff_ping;
typedef struct ff_welcome {
    uint32_t version;
    ff_terrain_info info;
    ff_list more; /* entries behind the terrain's, inside the message: see ff_welcome_ground */
} ff_welcome;
typedef struct ff_get_layer {
    uint8_t layer; /* FF_LAYER_NONE at most; 0 until it is said */
} ff_get_layer;
typedef struct ff_get_about {
    uint32_t entries; /* FF_ABOUT_BIT of those wanted */
} ff_get_about;
typedef struct ff_data {
    const uint8_t *bytes; /* inside the message, not copied */
    uint32_t byte_count;
} ff_data;
typedef struct ff_failed {
    uint16_t id;  /* 0: of the oldest request without a number that is not answered */
    int8_t error; /* enum ff_error */
} ff_failed;

enum ff_face_flags {
    FF_FACE_EMPTY = 1, /* no far ground in it: no image */
    FF_FACE_LAST = 2   /* the last face of its request */
};
/* A face and its flags share a byte of FACE, as a kind and a level share one of GET_NODE. */
FF_STATIC_ASSERT(FF_FACE_COUNT <= 16 && (FF_FACE_EMPTY | FF_FACE_LAST) < 16);
FF_STATIC_ASSERT(FF_KEY_LEVEL_MAX < 16);

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
    const uint8_t *image; /* paint of ff_face_blocks(face_size) by (row_count) blocks */
    uint32_t image_bytes;
} ff_face;

/* Blocks of 8 texels along a side of a face's image. */
static inline unsigned ff_face_blocks(unsigned texels) { return (texels + 7) / 8; }

/* One sector of a set. Flags as a face's. */
typedef struct ff_far {
    uint8_t sector, flags; /* enum ff_face_flags: FF_FACE_EMPTY, nothing follows; FF_FACE_LAST */
    const uint8_t *fins;   /* ff_fins_decode; no bytes: none */
    uint32_t fins_bytes;
    uint8_t blocks_x, blocks_y; /* of the paint, each of 8 x 8 texels; 0: no paint */
    int16_t top;          /* rows of texels that the first block row begins above O's horizon */
    const uint8_t *paint; /* ff_paint_decode */
    uint32_t paint_bytes;
} ff_far;

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
    /* of GET and ANSWER. Kinds that share an answer's type are decoded as the first of them: only
     * the request tells them apart */
    enum ff_kind kind;
    union {
        ff_hello hello;
        ff_get get;               /* GET, FF_ASKS_NODE */
        ff_get_view view;         /* GET, FF_ASKS_VIEW */
        ff_get_panorama panorama; /* GET, FF_ASKS_PANORAMA */
        ff_get_far get_far;       /* GET, FF_ASKS_FAR */
        ff_cancel cancel;
        ff_ping ping;
        ff_list list; /* CAPS, ABOUT: inside the message */
        ff_roots roots;
        ff_edge edge;
        ff_get_layer layer;
        ff_get_about get_about;
        ff_welcome welcome;
        ff_data data; /* ANSWER, FF_BRINGS_PAYLOAD */
        ff_part part; /* ANSWER, FF_BRINGS_PARTS */
        ff_face face; /* ANSWER, FF_BRINGS_FACE */
        ff_far far;   /* ANSWER, FF_BRINGS_FAR */
        ff_failed failed;
    } u;
} ff_message;

/* Bytes written to `out`, or FF_ERR_FULL, FF_ERR_RANGE. */
int ff_message_encode(const ff_message *message, uint8_t *out, size_t capacity);
/* Most bytes `message` can need, header included. */
size_t ff_message_bytes_max(const ff_message *message);

/* The request's number in a GET or an ANSWER; 0: it has none. */
uint16_t ff_message_id(const ff_message *message);

/* What a message's first byte says of its type: 0 when there is no such type; of GET and ANSWER the
 * first of the kinds, too, that share it. */
int ff_message_type_of(uint8_t byte, enum ff_kind *kind);
/* 1 when it is the first byte of a message that clients send. */
int ff_message_from_client(uint8_t byte);

/* How long the message is that begins here: 1, *header and *body together its bytes; 0: more bytes
 * are needed to know; FF_ERR_RANGE: longer than any; FF_ERR_FORMAT: no server sends it. */
int ff_message_measure(const uint8_t *bytes, size_t byte_count, uint32_t *header, uint32_t *body);
/* Takes one message off the front of `bytes`. Returns bytes consumed (> 0); 0 when more bytes are
 * needed, or a negative error (FORMAT: unknown type; RANGE; TRUNCATED: body shorter than its
 * fields), after which the stream is lost and must be closed. Pointers in `out` refer into `bytes`.
 * All fields are range-checked here. */
int ff_message_decode(const uint8_t *bytes, size_t byte_count, ff_message *out);

/* The grounds that a server tells of, at most FF_WELCOME_GROUNDS: the terrain, and those of the
 * entry TERRAINS, which lie beside it and whose tiles are numbered on (ff_terrain_join); or an
 * error of them. A WELCOME that was decoded has one at least. */
int ff_welcome_count(const ff_welcome *welcome);
/* One of them, and the checksum of the whole pack that it is a part of, or its own. */
void ff_welcome_ground(const ff_welcome *welcome, unsigned number, ff_terrain_info *info,
                       uint32_t *whole);
/* The layers of images over its grounds. */
void ff_welcome_layers(const ff_welcome *welcome, ff_layers *layers);
/* Bits of FF_LACKS_: of what a client need not ask for. */
uint32_t ff_welcome_lacks(const ff_welcome *welcome);

#endif
