/* Which texels of a panorama's faces show ground, from the whole true ground: a texel does when the
 * ray from O through its middle meets ground between the panorama's front and back. As the server
 * draws, but for its own level of detail, which is within a texel. The skyline of a level face is
 * one row for each of its columns, kept until another panorama is asked for; texels below it are
 * looked at one by one: the ground ends below, too, where nearer ground begins or there is none. */
#ifndef SIM_FACES_H
#define SIM_FACES_H

#include "sim_cube.h"
#include "sim_ground.h"

/* A panorama: where it was taken, and between which distances it shows ground. */
typedef struct sim_panorama {
    int32_t pos_wu[3];
    int32_t front_wu, back_wu; /* of the largest coordinate difference to O */
    unsigned face_size;        /* texels of a face each way */
} sim_panorama;

typedef struct sim_faces {
    const sim_ground *ground;
    sim_panorama of;
    unsigned known;                                /* bit per face whose skyline is known */
    uint16_t top[FF_FACE_COUNT][FF_FACE_SIZE_MAX]; /* first row with ground; face_size: none */
} sim_faces;

/* `faces` starts as zeros but for its ground. What is known of another panorama is forgotten. */
void sim_faces_use(sim_faces *faces, const sim_panorama *panorama);
/* 1 when the texel that a direction from O meets shows ground. */
int sim_faces_show(sim_faces *faces, const double direction[3]);
/* 1 when it shows ground or lies below one of its column that does: by this a skyline is sought. */
int sim_faces_reach(sim_faces *faces, const double direction[3]);

#endif
