/* One list of errors for all layers: name, number, text. Negative is an error, zero or more is an
 * answer. */
#ifndef FF_ERROR_H
#define FF_ERROR_H

#define FF_ERROR_LIST(X)                                             \
    X(FF_ERR_ARGUMENT, -1, "argument out of range")                  \
    X(FF_ERR_MEMORY, -2, "memory block too small")                   \
    X(FF_ERR_TRUNCATED, -3, "data ends too early")                   \
    X(FF_ERR_FORMAT, -4, "not a Farfield file or message")           \
    X(FF_ERR_VERSION, -5, "another version of Farfield")             \
    X(FF_ERR_CHECKSUM, -6, "checksum mismatch: the data is damaged") \
    X(FF_ERR_RANGE, -7, "a field is out of range")                   \
    X(FF_ERR_NOT_FOUND, -8, "no such node, texture or file")         \
    X(FF_ERR_FULL, -9, "pool or buffer full")                        \
    X(FF_ERR_AGAIN, -10, "would block, try again")                   \
    X(FF_ERR_CLOSED, -11, "connection closed by the peer")           \
    X(FF_ERR_SYSTEM, -12, "the operating system refused")            \
    X(FF_ERR_UNSUPPORTED, -13, "not supported by this build")

enum ff_error {
    FF_OK = 0,
#define X(name, number, text) name = number,
    FF_ERROR_LIST(X)
#undef X
        FF_ERR_LAST = -13
};

/* A constant one-line text; "ok" for 0 or more, "unknown error" beyond the list. */
const char *ff_error_text(int error);

#endif
