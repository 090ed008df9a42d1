// SPDX-License-Identifier: Apache-2.0
#include "cli/render/render_plan.h"

#include "core/job/frame_range.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static int set_up(void **state)
{
    static struct frame_range frames;
    static struct render_plan plan;

    if (!frame_range_parse(&frames, "1-5", NULL)) return -1;
    plan = (struct render_plan){.frames = &frames};
    *state = &plan;
    return 0;
}

static int tear_down(void **state)
{
    struct render_plan *plan = *state;

    frame_range_finish((struct frame_range *)plan->frames);
    return 0;
}

static void assert_taken(struct render_plan *plan, int32_t frame, int attempt)
{
    struct render_ticket ticket;

    assert_true(render_plan_take(plan, &ticket));
    assert_int_equal(ticket.frame, frame);
    assert_int_equal(ticket.attempt, attempt);
}

static void assert_enough(struct render_plan *plan)
{
    struct render_ticket ticket;

    assert_false(render_plan_take(plan, &ticket));
}

static void worker_is_given_a_few_frames_ahead(void **state)
{
    struct render_plan *plan = *state;

    assert_taken(plan, 1, 1);
    assert_taken(plan, 2, 1);
    assert_taken(plan, 3, 1);
    assert_enough(plan);
    assert_true(render_plan_end(plan, 1, 1));
    assert_taken(plan, 4, 1);
    assert_enough(plan);
}

static void plan_is_done_when_all_ended(void **state)
{
    struct render_plan *plan = *state;

    for (int32_t frame = 1; frame <= 5; frame++) {
        assert_false(render_plan_is_done(plan));
        assert_taken(plan, frame, 1);
        assert_true(render_plan_end(plan, frame, 1));
    }
    assert_true(render_plan_is_done(plan));
    assert_enough(plan);
}

static void ends_of_other_attempts_count_for_nothing(void **state)
{
    struct render_plan *plan = *state;

    assert_taken(plan, 1, 1);
    assert_false(render_plan_end(plan, 1, 2));
    assert_false(render_plan_end(plan, 2, 1));
    assert_true(render_plan_end(plan, 1, 1));
    assert_false(render_plan_end(plan, 1, 1));
}

static void lost_frames_are_tried_again_alone_and_first(void **state)
{
    struct render_ticket given_up[RENDER_PLAN_AHEAD];
    struct render_plan *plan = *state;

    assert_taken(plan, 1, 1);
    assert_taken(plan, 2, 1);
    assert_taken(plan, 3, 1);
    render_plan_start(plan, 1);
    assert_int_equal(render_plan_lose(plan, false, given_up), 0);
    assert_taken(plan, 1, 2); // it had started, so the attempt counts
    assert_enough(plan);
    assert_true(render_plan_end(plan, 1, 2));
    assert_taken(plan, 2, 1);
    assert_enough(plan);
    assert_true(render_plan_end(plan, 2, 1));
    assert_taken(plan, 3, 1);
    assert_taken(plan, 4, 1);
}

static void frame_that_kills_every_worker_is_given_up_alone(void **state)
{
    struct render_ticket given_up[RENDER_PLAN_AHEAD];
    struct render_plan *plan = *state;
    struct render_ticket ticket;
    size_t count = 0;

    for (int i = 0; i < RENDER_PLAN_ATTEMPTS; i++) {
        assert_int_equal(count, 0);
        while (render_plan_take(plan, &ticket))
            ;
        render_plan_start(plan, 1);
        count = render_plan_lose(plan, false, given_up);
    }
    assert_int_equal(count, 1);
    assert_int_equal(given_up[0].frame, 1);
    assert_taken(plan, 2, 1);
    assert_true(render_plan_end(plan, 2, 1));
    assert_taken(plan, 3, 1);
}

static void an_endless_frame_is_given_up_and_what_was_rendered_before_it_is_not(void **state)
{
    struct render_plan *plan = *state;
    struct render_ticket given_up[RENDER_PLAN_AHEAD];

    for (int frame = 1; frame <= 3; frame++)
        assert_taken(plan, frame, 1);
    render_plan_start(plan, 1);
    render_plan_render(plan, 1);
    render_plan_start(plan, 2);
    assert_int_equal(render_plan_lose(plan, true, given_up), 1);
    assert_int_equal(given_up[0].frame, 2);
    assert_taken(plan, 1, 2);
    assert_true(render_plan_end(plan, 1, 2));
    assert_taken(plan, 3, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(worker_is_given_a_few_frames_ahead, set_up, tear_down),
        cmocka_unit_test_setup_teardown(plan_is_done_when_all_ended, set_up, tear_down),
        cmocka_unit_test_setup_teardown(ends_of_other_attempts_count_for_nothing, set_up, tear_down),
        cmocka_unit_test_setup_teardown(lost_frames_are_tried_again_alone_and_first, set_up, tear_down),
        cmocka_unit_test_setup_teardown(frame_that_kills_every_worker_is_given_up_alone, set_up, tear_down),
        cmocka_unit_test_setup_teardown(an_endless_frame_is_given_up_and_what_was_rendered_before_it_is_not, set_up,
                                        tear_down),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
