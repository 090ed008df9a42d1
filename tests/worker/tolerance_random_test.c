// Scenes and moments that no plan was made for by hand keep their tolerance, by the light of every pixel.
#include "core/error.h"
#include "core/job.h"
#include "core/job_json.h"
#include "tests/support/keep_libraries.h"
#include "tests/support/random_job.h"
#include "tests/support/temp_folder.h"
#include "tests/support/true_error.h"
#include "worker/gl_context.h"
#include "worker/image.h"
#include "worker/tolerance.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 16, HEIGHT_PX = 12 };

struct outcome {
    int frames, seconds, within, refused;
};

// What an estimate leaves open: a frame may pass whose true error is over its tolerance, but not by much, and seldom.
static const double SLACK = 1.25;

static void try(struct tolerance *tolerance, const char *text, int64_t serial, double allowed, struct outcome *outcome)
{
    struct error error = {{0}};
    struct tolerance_result result;
    struct image image;
    struct job job;
    double truly;

    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s\n%s", error.message, text);
    assert_true(image_init(&image, WIDTH_PX, HEIGHT_PX, true, true, NULL));
    outcome->frames++;
    if (tolerance_render(tolerance,
                         &(struct tolerance_params){.job = &job, .serial = serial, .frame = 0, .image = &image},
                         &result, &error)) {
        truly = true_error_measure(&job, 0, &image);
        print_message("%d: tolerance %g: truly %.2e, audited %.2e (at most %.2e), foretold by %s\n", (int)serial,
                      allowed, truly, result.audit.error, result.audit.error95, result.reason);
        if (truly > SLACK * allowed) fail_msg("%s", text);
        outcome->within += truly <= allowed;
        outcome->seconds += result.is_second;
    } else {
        print_message("%d: %s\n", (int)serial, error.message);
        assert_int_equal(result.render.fault, RENDERER_FAULT_MISSED);
        outcome->refused++;
    }
    image_finish(&image);
    job_finish(&job);
}

static void random_scenes_keep_their_tolerance(void **state)
{
    static const double tolerances[] = {0.1, 0.03, 0.01};
    enum { FIRST = 101, LAST = 108 };
    const char *volume = temp_folder_path(state, "random.nrrd");
    struct gl_context *context = gl_context_create(GL_BACKEND_OSMESA, NULL, NULL);
    struct renderer *renderer;
    struct tolerance *tolerance;
    struct outcome outcome = {0};

    assert_non_null(context);
    keep_libraries();
    renderer = renderer_create(context, NULL);
    tolerance = tolerance_create(renderer);
    random_job_write_volume(volume);
    for (uint64_t seed = FIRST; seed <= LAST; seed++) {
        double allowed = tolerances[seed % 3];
        char quality[64], *text;

        snprintf(quality, sizeof quality, "{\"tolerance\": %g}", allowed);
        text = random_job_write(&(struct random_job){volume, seed, quality, WIDTH_PX, HEIGHT_PX});
        try(tolerance, text, (int64_t)seed, allowed, &outcome);
        free(text);
    }
    tolerance_destroy(tolerance);
    renderer_destroy(renderer);
    gl_context_destroy(context);
    print_message("of %d frames %d are within, %d at the second try, %d given up\n", outcome.frames, outcome.within,
                  outcome.seconds, outcome.refused);
    assert_int_equal(outcome.refused, 0);
    assert_true(outcome.within >= outcome.frames - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(random_scenes_keep_their_tolerance, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
