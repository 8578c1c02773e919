/* The renderer of a process: opened by the command line's --gl. */
#ifndef SERVER_RENDERER_H
#define SERVER_RENDERER_H

#include "../panorama/ff_panorama_render.h"
#include "../server.h"

/* FF_OK or a negative error. */
int server_renderer_open(const server *shared, ff_panorama_renderer **renderer);
/* Renders one face and counts it; as ff_panorama_render_face. */
int server_renderer_face(ff_panorama_renderer *renderer, const ff_face_job *job,
                         server_counters *counters, uint8_t *out, size_t capacity);

#endif
