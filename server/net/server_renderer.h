/* What draws in a process: faces as the command line's --gl says, far sets without a GL. */
#ifndef SERVER_RENDERER_H
#define SERVER_RENDERER_H

#include "../far/ff_far_render.h"
#include "../panorama/ff_panorama_render.h"
#include "../server.h"

typedef struct server_renderer {
    ff_panorama_renderer *faces; /* NULL: no GL draws them here */
    ff_far_renderer *far;
} server_renderer;

/* FF_OK or a negative error. */
int server_renderer_open(const server *shared, server_renderer *renderer);
void server_renderer_close(server_renderer *renderer);
/* Renders one face or sector and counts it; as ff_panorama_render_face. */
int server_renderer_draw(server_renderer *renderer, const ff_face_job *job,
                         server_counters *counters, uint8_t *out, size_t capacity);

#endif
