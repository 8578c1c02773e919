/* A text out of a JSON object, as descriptions of map tiles are. */
#ifndef BAKE_JSON_H
#define BAKE_JSON_H

#include <stddef.h>

/* The text named `name` in the object itself, not in what lies inside it: written to `value`, which
 * stays as it is when there is none, or when it is longer than the room. */
void bake_json_text(const char *json, const char *name, char *value, size_t room);

#endif
