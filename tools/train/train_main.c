/* farfield-train: the tables of the codec "trained", from packs. */
#include "../../client/farfield.h"
#include "../../platform/options/sys_options.h"
#include "../bake/bake_say.h"
#include "train_far.h"
#include "train_fit.h"
#include "train_ground.h"
#include "train_picture.h"
#include "train_write.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDS     6
#define BY_LEVEL   3 /* the first of them */
#define GROUNDS    32
#define ERRORS     4
#define FINE_M     0.02
#define COARSE_M   0.5
#define FIRST_LOG2 3 /* of nodes that are trained with: this and the next */

static const double error_m[ERRORS] = { 0, 1, 4, 10 };

/* clang-format off */
#define TRAIN_OPTIONS(OPTION) \
    OPTION(sys_text, out, "output", "FILE", NULL, SYS_ANY, "writes the tables there, as C; with --far into this folder") \
    OPTION(sys_text, packs, NULL, "PACKS", NULL, SYS_FLAGS(SYS_NEEDED), \
           "packs to train on, with commas between them") \
    OPTION(sys_flag, pictures, "pictures", NULL, NULL, SYS_ANY, \
           "learns of their images, baked with --texture-quality 100") \
    OPTION(sys_flag, far, "far", NULL, NULL, SYS_ANY, "learns of their far ground, as sets show it") \
    OPTION(sys_text, measured, "measure", "PACKS", NULL, SYS_ANY, "packs to code with the tables, likewise")
/* clang-format on */

typedef struct train_options {
    TRAIN_OPTIONS(SYS_FIELD)
} train_options;

#define ROW(type, field, name, value, fallback, range, help) \
    SYS_OPTION(train_options, type, field, name, value, fallback, help, range)
static const sys_option row[] = { TRAIN_OPTIONS(ROW) };
#undef ROW

static const sys_program program = {
    .name = "farfield-train",
    .version = FARFIELD_VERSION,
    .usage = "[--pictures|--far] [--output FILE] [--measure PACKS] PACKS",
    .about =
        "Learns what heights to expect of ground, for the codec \"trained\": each pack is coded "
        "with errors of 0, 1, 4 and 10 m, ten times, where its steps are coarse in finer ones, too. "
        "Or the tables of pictures, from images, with five qualities, three times; or those of far "
        "sets, from what is seen of four places at four heights.",
    .option = row,
    .option_count = sizeof row / sizeof *row
};

typedef struct grounds {
    train_ground ground[GROUNDS];
    unsigned count;
} grounds;

/* `finer`: also as it would be in finer steps, where its own are coarse. */
static int open_one(grounds *all, const char *name, int finer)
{
    if (all->count == GROUNDS) return bake_fail("more than %d grounds", GROUNDS);
    train_ground *ground = &all->ground[all->count++];
    if (train_ground_open(ground, name)) return -1;
    if (ground->max_error) return bake_fail("%s: bake it without --max-error to train on it", name);
    if (!finer || ground->step_m < COARSE_M) return 0;
    if (all->count == GROUNDS) return bake_fail("more than %d grounds", GROUNDS);
    return train_ground_refine(&all->ground[all->count++], ground);
}

static int open_all(grounds *all, const char *names, int finer)
{
    char *text = strdup(names), *rest = NULL;
    int rc = text ? 0 : bake_fail("out of memory");
    for (char *name = rc ? NULL : strtok_r(text, ",", &rest); name && !rc;
         name = strtok_r(NULL, ",", &rest))
        rc = open_one(all, name, finer);
    return rc; /* grounds keep their names */
}

/* Of ground told in centimetres a fortieth. */
static uint32_t steps(const train_ground *ground, unsigned error)
{
    double metres = ground->step_m < FINE_M ? error_m[error] / 40 : error_m[error];
    return (uint32_t)lrint(metres / ground->step_m);
}

/* ---- training ---- */

typedef struct learner {
    train_sums *sums; /* NULL: counting */
    train_counts *counts;
} learner;

static void learn(void *context, const train_point *point)
{
    learner *l = context;
    if (l->sums)
        train_sum(l->sums, point);
    else
        train_count(l->counts, point);
}

static void go_over(const grounds *all, const ff_trained *by, enum train_choice choice, learner *l)
{
    const train_eye eye = { .context = l, .point = learn };
    for (unsigned i = 0; i < all->count; i++)
        for (unsigned error = 0; error < ERRORS; error++)
            train_ground_make(&all->ground[i], by, choice, FIRST_LOG2 + (i + error) % 2,
                              steps(&all->ground[i], error), &eye);
}

static void learn_weights(const grounds *all, enum train_choice choice, train_sums *sums,
                          ff_trained *tables)
{
    learner l = { .sums = sums };
    memset(sums, 0, FF_TRAINED_SETS * sizeof *sums);
    go_over(all, tables, choice, &l);
    train_weights(sums, tables);
}

static void learn_probabilities(const grounds *all, enum train_choice choice, train_counts *counts,
                                ff_trained *tables)
{
    learner l = { .counts = counts };
    memset(counts, 0, sizeof *counts);
    go_over(all, tables, choice, &l);
    train_probabilities(counts, tables);
}

static int train(const grounds *all, ff_trained *tables)
{
    train_counts *counts = malloc(sizeof *counts);
    train_sums *sums = malloc(FF_TRAINED_SETS * sizeof *sums);
    int rc = counts && sums ? 0 : bake_fail("out of memory");
    train_begin(tables);
    for (unsigned i = 0; i < ROUNDS && !rc; i++) {
        enum train_choice choice = i < BY_LEVEL ? TRAIN_BY_LEVEL : TRAIN_AS_ENCODER;
        learn_weights(all, choice, sums, tables);
        if (i + 1 >= BY_LEVEL) learn_probabilities(all, choice, counts, tables);
    }
    if (!rc && !train_weights_fit(tables))
        bake_note("sums of these weights may take more than 32 bits: they are not for the format");
    free(sums);
    free(counts);
    return rc;
}

/* ---- measuring ---- */

static void pass(void *context, const train_point *point) { (void)context, (void)point; }

static void add(void *context, size_t bytes) { *(uint64_t *)context += bytes; }

static void measure(const grounds *all, const ff_trained *tables)
{
    for (unsigned i = 0; i < all->count; i++)
        for (unsigned log2 = FIRST_LOG2; log2 < FIRST_LOG2 + 2; log2++) {
            printf("%s, nodes of %u:", all->ground[i].path, (1u << log2) + 1);
            for (unsigned error = 0; error < ERRORS; error++) {
                uint64_t bytes = 0;
                const train_eye eye = { &bytes, pass, add };
                uint64_t samples = train_ground_make(&all->ground[i], tables, TRAIN_AS_ENCODER,
                                                     log2, steps(&all->ground[i], error), &eye);
                printf("  %g m %.3f", error_m[error], 8.0 * (double)bytes / (double)samples);
            }
            puts(" bits a sample");
        }
}

static int train_heights(const train_options *options)
{
    static grounds taught, measured;
    static ff_trained tables;
    int rc = open_all(&taught, options->packs, 1) ||
             (options->measured && open_all(&measured, options->measured, 0)) ||
             train(&taught, &tables);
    if (!rc) measure(&measured, &tables);
    if (!rc && options->out) rc = train_write(options->out, &tables);
    for (unsigned i = 0; i < taught.count; i++) train_ground_close(&taught.ground[i]);
    for (unsigned i = 0; i < measured.count; i++) train_ground_close(&measured.ground[i]);
    return rc;
}

/* ---- pictures ---- */

typedef struct albums {
    train_pictures album[GROUNDS];
    unsigned count;
} albums;

static int open_albums(albums *all, const char *names)
{
    char *text = strdup(names), *rest = NULL;
    int rc = text ? 0 : bake_fail("out of memory");
    for (char *name = rc ? NULL : strtok_r(text, ",", &rest); name && !rc;
         name = strtok_r(NULL, ",", &rest)) {
        if (all->count == GROUNDS) return bake_fail("more than %d packs", GROUNDS);
        rc = train_pictures_open(&all->album[all->count++], name);
    }
    return rc; /* albums keep their names */
}

static int train_images(const train_options *options)
{
    static albums taught, measured;
    static ff_picture_tables tables;
    int rc = open_albums(&taught, options->packs) ||
             (options->measured && open_albums(&measured, options->measured)) ||
             train_pictures_learn(taught.album, taught.count, &tables);
    for (unsigned i = 0; !rc && i < measured.count; i++)
        rc = train_pictures_measure(&measured.album[i], &tables);
    if (!rc && options->out) rc = train_pictures_write(options->out, &tables);
    for (unsigned i = 0; i < taught.count; i++) train_pictures_close(&taught.album[i]);
    for (unsigned i = 0; i < measured.count; i++) train_pictures_close(&measured.album[i]);
    return rc;
}

/* ---- far ground ---- */

static int open_vistas(train_vistas *all, const char *names)
{
    char *text = strdup(names), *rest = NULL;
    int rc = text ? 0 : bake_fail("out of memory");
    for (char *name = rc ? NULL : strtok_r(text, ",", &rest); name && !rc;
         name = strtok_r(NULL, ",", &rest))
        rc = train_vistas_add(all, name);
    return rc; /* vistas keep their names */
}

static int train_far(const train_options *options)
{
    static train_vistas taught, measured;
    static train_far_tables tables;
    int rc = open_vistas(&taught, options->packs) ||
             (options->measured && open_vistas(&measured, options->measured)) ||
             train_far_learn(&taught, &tables);
    if (!rc && options->measured) rc = train_far_measure(&measured, &tables);
    if (!rc && options->out) rc = train_far_write(options->out, &tables);
    train_vistas_close(&taught);
    train_vistas_close(&measured);
    return rc;
}

int main(int argc, char **argv)
{
    train_options options = { 0 };
    bake_say_setup("farfield-train", 0);
    int rc = sys_options_parse(&program, &options, argc, argv);
    if (rc) return rc < 0 ? SYS_EXIT_USAGE : SYS_EXIT_DONE;
    rc = options.far        ? train_far(&options)
         : options.pictures ? train_images(&options)
                            : train_heights(&options);
    return rc ? SYS_EXIT_FAILED : SYS_EXIT_DONE;
}
