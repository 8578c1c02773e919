/* The picture difference: figures of pictures made by hand, against values known from the formulas
 * and a slow way to the same. */
#include "../../sim/judge/sim_picture.h"

#include "../../protocol/ff_error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH  40
#define HEIGHT 30
#define PIXELS (WIDTH * HEIGHT)

typedef struct picture {
    uint8_t rgb[PIXELS][3];
} picture;

static int near(double a, double b) { return fabs(a - b) < 1e-9; }

static void set(uint8_t rgb[3], int red, int green, int blue)
{
    rgb[0] = (uint8_t)red;
    rgb[1] = (uint8_t)green;
    rgb[2] = (uint8_t)blue;
}

static void fill(picture *of, int red, int green, int blue)
{
    for (int i = 0; i < PIXELS; i++) set(of->rgb[i], red, green, blue);
}

/* Hills of grey, dark in the west. */
static void hills(picture *of)
{
    for (int i = 0; i < PIXELS; i++) {
        int grey = 60 + 3 * (i % WIDTH) + (i * 37 + i / WIDTH * 11) % 29;
        set(of->rgb[i], grey, grey, grey);
    }
}

static sim_picture_figures compare(const picture *shown, const picture *truth)
{
    sim_picture_figures figures;
    assert_int_equal(sim_picture_compare(shown->rgb[0], truth->rgb[0], WIDTH, HEIGHT, &figures),
                     FF_OK);
    return figures;
}

static void the_same_picture_differs_by_nothing(void **state)
{
    (void)state;
    picture a;
    hills(&a);
    sim_picture_figures figures = compare(&a, &a);
    assert_true(figures.diff_mean == 0 && figures.diff_p95 == 0 && near(figures.ssim, 1));
}

/* Flat pictures have no variance: what is left of the formula is its first factor. */
static void a_grey_level_is_one_everywhere(void **state)
{
    (void)state;
    picture a, b;
    fill(&a, 100, 100, 100);
    fill(&b, 101, 101, 101);
    sim_picture_figures figures = compare(&a, &b);
    const double c1 = 2.55 * 2.55;
    assert_true(near(figures.diff_mean, 1) && near(figures.diff_p95, 1));
    assert_true(near(figures.ssim, (2 * 100 * 101 + c1) / (100 * 100 + 101 * 101 + c1)));
    fill(&b, 0, 0, 0);
    figures = compare(&a, &b);
    assert_true(near(figures.diff_mean, 100) && near(figures.ssim, c1 / (10000 + c1)));
}

/* The formula as it stands in the paper, over the one window of an 11 x 11 picture. */
static double slow_ssim(uint8_t shown[121][3], uint8_t truth[121][3])
{
    double weight[121], sum = 0, mean[2] = { 0, 0 }, variance[2] = { 0, 0 }, covariance = 0;
    for (int i = 0; i < 121; i++) {
        int x = i % 11 - 5, y = i / 11 - 5;
        sum += weight[i] = exp(-(x * x + y * y) / 4.5);
    }
    for (int i = 0; i < 121; i++) {
        mean[0] += weight[i] / sum * shown[i][1];
        mean[1] += weight[i] / sum * truth[i][1];
    }
    for (int i = 0; i < 121; i++) {
        double a = shown[i][1] - mean[0], b = truth[i][1] - mean[1];
        variance[0] += weight[i] / sum * a * a;
        variance[1] += weight[i] / sum * b * b;
        covariance += weight[i] / sum * a * b;
    }
    const double c1 = 2.55 * 2.55, c2 = 7.65 * 7.65;
    return (2 * mean[0] * mean[1] + c1) * (2 * covariance + c2) /
           ((mean[0] * mean[0] + mean[1] * mean[1] + c1) * (variance[0] + variance[1] + c2));
}

static void similarity_is_that_of_the_paper(void **state)
{
    (void)state;
    uint8_t a[121][3], b[121][3];
    sim_picture_figures figures;
    for (int i = 0; i < 121; i++) {
        int grey = (i * 53 + 17) % 256, other = 255 - (i * 29 + 5) % 200;
        set(a[i], grey, grey, grey);
        set(b[i], other, other, other);
    }
    assert_int_equal(sim_picture_compare(a[0], b[0], 11, 11, &figures), FF_OK);
    assert_true(near(figures.ssim, slow_ssim(a, b)));
    assert_true(figures.ssim < 0.5);
    assert_int_equal(sim_picture_compare(a[0], a[0], 11, 10, &figures), FF_OK);
    assert_true(isnan(figures.ssim) && figures.diff_mean == 0); /* no window fits */
}

static void colours_count_by_their_luminance(void **state)
{
    (void)state;
    picture a, b;
    fill(&a, 100, 100, 100);
    fill(&b, 110, 100, 100);
    assert_true(near(compare(&a, &b).diff_mean, 2.99));
    fill(&b, 100, 110, 100);
    assert_true(near(compare(&a, &b).diff_mean, 5.87));
    fill(&b, 100, 100, 110);
    assert_true(near(compare(&a, &b).diff_mean, 1.14));
    fill(&b, 0, 100, 150); /* darker red, brighter blue */
    assert_true(near(compare(&a, &b).diff_mean, 24.2));
}

/* The 95th percentile is what 95 of 100 pixels do not pass. */
static void a_twentieth_of_the_pixels_may_pass_the_percentile(void **state)
{
    (void)state;
    picture a, b;
    fill(&a, 10, 10, 10);
    b = a;
    for (int i = 0; i < PIXELS / 20; i++) set(b.rgb[i * 20 + 7], 90, 90, 90);
    assert_true(compare(&a, &b).diff_p95 == 0);
    set(b.rgb[0], 90, 90, 90);
    assert_true(near(compare(&a, &b).diff_p95, 80));
}

static void a_seam_counts(void **state)
{
    (void)state;
    picture a, b;
    hills(&a);
    b = a;
    for (int y = 0; y < HEIGHT; y++) set(b.rgb[y * WIDTH + 20], 255, 255, 255);
    sim_picture_figures figures = compare(&b, &a);
    assert_true(figures.diff_mean > 2 && figures.diff_p95 == 0 && figures.ssim < 0.8);
}

static void ground_in_another_place_counts(void **state)
{
    (void)state;
    picture a, b;
    hills(&a);
    for (int i = 0; i < PIXELS; i++) /* east and west halves swapped */
        memcpy(b.rgb[i], a.rgb[i / WIDTH * WIDTH + (i + WIDTH / 2) % WIDTH], 3);
    sim_picture_figures figures = compare(&b, &a);
    assert_true(figures.diff_mean > 40 && figures.diff_p95 > 50 && figures.ssim < 0.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_picture_differs_by_nothing),
        cmocka_unit_test(a_grey_level_is_one_everywhere),
        cmocka_unit_test(similarity_is_that_of_the_paper),
        cmocka_unit_test(colours_count_by_their_luminance),
        cmocka_unit_test(a_twentieth_of_the_pixels_may_pass_the_percentile),
        cmocka_unit_test(a_seam_counts),
        cmocka_unit_test(ground_in_another_place_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
