/* The balance while the link idles: nobody knows then what finer ground would take. */
#include "../../client/balance/ff_balance.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#define STEP_US   100000
#define SECOND_US INT64_C(1000000)
#define LINK      FF_BALANCE_FIDELITY

/* It comes back, but not all at once before the next turn. */
static void detail_comes_back_two_steps_at_a_time(void **state)
{
    static const ff_quality finest = {
        .measure = FF_MEASURE_PIXELS, .c_q8 = 3 * 256, .error_px_q8 = 256, .triangles_max = 1 << 15
    };
    const ff_balance_desc desc = { .mode = FF_BALANCE_ON };
    ff_balance balance;
    ff_balance_sample sample = { .triangles = 1000, .rate_bytes_s = 20000 };
    unsigned raises = 0;

    (void)state;
    ff_balance_set(&balance, &desc, &finest, NULL, 0, 1);
    balance.level[LINK] = 0;
    while (balance.level[LINK] < balance.top[LINK]) {
        unsigned before = balance.level[LINK];
        ff_balance_knobs knobs;
        ff_balance_get(&balance, &knobs);
        sample.c_q8 = knobs.c_q8;
        sample.error_px_q8 = knobs.error_px_q8;
        (void)ff_balance_feed(&balance, &sample);
        assert_in_range(balance.level[LINK], before, before + 2);
        raises += balance.level[LINK] > before;
        sample.now_us += STEP_US;
        assert_true(sample.now_us < 120 * SECOND_US);
    }
    assert_int_equal(balance.top[LINK], 12);
    assert_int_equal(raises, 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(detail_comes_back_two_steps_at_a_time) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
