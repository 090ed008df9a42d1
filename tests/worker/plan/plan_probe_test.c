// Probes of a frame measure its own pixels: what whole frames in the same settings show at those places, to the bit.
// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_probe.h"

#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/example_job.h"
#include "tests/support/tolerance_stage.h"
#include "worker/audit/audit.h"
#include "worker/picture/image.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_make.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_retry.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { FRAME = 17 };

static struct image render(struct renderer *renderer, const struct job *job)
{
    struct error error = {{0}};
    struct renderer_result result;
    struct image image;

    if (!image_init_for_job(&image, job, &error) ||
        !renderer_render(renderer, &(struct renderer_frame){.job = job, .frame = FRAME, .image = &image}, &result,
                         &error))
        fail_msg("%s", error.message);
    return image;
}

static struct image pick(const struct plan_lattice *lattice, const struct image *frame)
{
    struct image picked;

    assert_true(image_init(&picked, lattice->columns, lattice->rows, false, false, NULL));
    for (size_t i = 0; i < plan_lattice_count(lattice); i++)
        memcpy(&picked.rgba[4 * i],
               &frame->rgba[4 * (size_t)(lattice->pixels[i].y * frame->width_px + lattice->pixels[i].x)],
               4 * sizeof(float));
    return picked;
}

static double find_change(const struct image *a, const struct image *b)
{
    size_t count = (size_t)a->width_px * (size_t)a->height_px;
    double sum = 0.0;

    for (size_t i = 0; i < 4 * count; i++)
        if (i % 4 < 3) sum += ((double)a->rgba[i] - b->rgba[i]) * ((double)a->rgba[i] - b->rgba[i]);
    return sqrt(sum / (3.0 * (double)count));
}

// Three samples in an open shutter: a picture of another size, or of one sample, has other colours.
static void what_is_to_blame_is_told_by_the_frames_own_pixels(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    const struct plan_point point = {.rungs = {4, 4, 2, 0}};
    struct plan plan = {.point = point};
    struct plan_params params = {.renderer = stage.renderer};
    double changes[PLAN_AXIS_LIMIT] = {0.0};
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    struct plan_lattice lattice;
    struct image frame, seen;
    struct plan_retry retry;
    struct plan_scene scene;
    enum renderer_fault fault;
    struct job job, planned;
    int count;

    (void)state;
    example_job_load(&job, "cloud");
    example_job_shrink(&job, 64, 36, 2.0);
    job.quality = (struct job_quality){.method = JOB_METHOD_AUTO, .tolerance = 0.01, .samples = 3};
    job.scene.camera.shutter = 0.5;
    params.job = &job;
    plan_scene_init(&scene, &job);
    while (plan_families[plan.family].method != JOB_METHOD_MIDPOINT)
        plan.family++;
    plan.quality = plan_family_quality(&plan_families[plan.family], &scene, &point);
    planned = plan_apply(&plan, &job);
    frame = render(stage.renderer, &planned);
    plan_retry_init(&retry, &job, &frame, &plan);
    count = plan_retry_axes(&retry, &plan, axes);
    assert_true(plan_probe_axes(&(struct plan_probe){.params = &params, .frame = FRAME, .plan = &plan, .image = &frame},
                                &retry, changes, &fault, NULL));
    plan_probe_init_lattice(&lattice, &job, &frame);
    seen = pick(&lattice, &frame);
    assert_true(count > 1 && plan_lattice_count(&lattice) >= 100);
    for (int i = 0; i < count; i++) {
        struct plan varied = plan;
        struct image other, other_seen;

        plan_retry_vary(&retry, &varied, i);
        planned = plan_apply(&varied, &job);
        other = render(stage.renderer, &planned);
        other_seen = pick(&lattice, &other);
        assert_true(changes[i] > 0.0 && changes[i] == find_change(&other_seen, &seen));
        image_finish(&other);
        image_finish(&other_seen);
    }
    // Counted are the rays of the lattice, in all samples.
    assert_true(retry.spent_work > 0.0 && retry.spent_work < 2.0 * retry.first_work);
    plan_lattice_finish(&lattice);
    image_finish(&frame);
    image_finish(&seen);
    job_finish(&job);
    gl_stage_close(stage);
}

// The march of scattered light is judged by few cells and walks, relative to the light; what they add is left alone.
static void a_march_of_scattered_light_is_judged_by_little_of_it(void **state)
{
    enum { STEP, LIGHT, OPACITY, CELLS, PATHS, AXES };
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    const struct plan_point point = {.rungs = {1, 3, 2, 6, 10}}, light = {.rungs = {1, 3, 2, 4, 12}};
    struct plan plan = {.point = point, .cells_square = 1e-6, .paths_square = 1e-6}, lightened;
    struct plan_params params = {.renderer = stage.renderer};
    double changes[PLAN_AXIS_LIMIT] = {[CELLS] = 7.0, [PATHS] = 8.0};
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    struct plan_lattice lattice;
    struct image frame, black, lit, seen;
    struct plan_retry retry;
    struct plan_scene scene;
    enum renderer_fault fault;
    struct job job, planned;
    double mean;

    (void)state;
    example_job_load(&job, "cloud");
    example_job_shrink(&job, 48, 27, 2.0);
    job.quality = (struct job_quality){.method = JOB_METHOD_AUTO, .tolerance = 0.05, .samples = 1};
    job.scene.orders = 3;
    params.job = &job;
    plan_scene_init(&scene, &job);
    while (plan_families[plan.family].method != JOB_METHOD_MIDPOINT)
        plan.family++;
    plan.quality = plan_family_quality(&plan_families[plan.family], &scene, &point);
    planned = plan_apply(&plan, &job);
    frame = render(stage.renderer, &planned);
    plan_retry_init(&retry, &job, &frame, &plan);
    assert_int_equal(plan_retry_axes(&retry, &plan, axes), AXES);
    assert_true(axes[STEP] == PLAN_AXIS_STEP && axes[CELLS] == PLAN_AXIS_SCATTER_GRID &&
                axes[PATHS] == PLAN_AXIS_NODE_PATHS);
    assert_true(
        plan_probe_march(&(struct plan_probe){.params = &params, .frame = FRAME, .plan = &plan, .image = &frame},
                         &retry, changes, &fault, NULL));
    assert_true(changes[CELLS] == 7.0 && changes[PATHS] == 8.0);
    plan_probe_init_lattice(&lattice, &job, &frame);
    lightened = plan;
    lightened.point = light;
    lightened.quality = plan_family_quality(&plan_families[plan.family], &scene, &light);
    planned = plan_apply(&lightened, &job);
    lit = render(stage.renderer, &planned);
    seen = pick(&lattice, &lit);
    black = pick(&lattice, &lit);
    memset(black.rgba, 0, 4 * sizeof(float) * plan_lattice_count(&lattice));
    mean = find_change(&seen, &black);
    for (int i = STEP; i <= OPACITY; i++) {
        struct plan varied = lightened;
        struct image other, other_seen;

        plan_retry_vary(&retry, &varied, i);
        planned = plan_apply(&varied, &job);
        other = render(stage.renderer, &planned);
        other_seen = pick(&lattice, &other);
        print_message("axis %d: %.3e\n", i, changes[i]);
        // The error falls with the length of a step to the power of 1.5: half of it leaves 0.35, twice has 2.83.
        assert_float_equal(
            changes[i], find_change(&other_seen, &seen) / mean / (light.rungs[i] < 2 ? 1 - exp2(-1.5) : exp2(1.5) - 1),
            1e-9);
        image_finish(&other);
        image_finish(&other_seen);
    }
    assert_true(changes[STEP] > 0.01); // steps as long as the cloud is wide are to blame
    plan_lattice_finish(&lattice);
    image_finish(&frame);
    image_finish(&lit);
    image_finish(&seen);
    image_finish(&black);
    job_finish(&job);
    gl_stage_close(stage);
}

static void parse(struct job *job)
{
    static const char text[] =
        "{\"version\":1,\"name\":\"glow\",\"frames\":\"0-23\",\"fps\":24,\"resolution\":[64,36],"
        "\"camera\":{\"position\":[0,0.3,-3],\"target\":[0,0,0],\"fov\":45,\"shutter\":0.5},"
        "\"scene\":{\"media\":[{\"sigma_a\":2,\"emission\":1,\"density\":{\"kind\":\"glsl\",\"lipschitz\":20,"
        "\"source\":\"float density(vec3 p, float t) { return 1.0 + 0.5 * sin(9.0 * p.x + 3.0 * t) * sin(9.0 * p.y); }"
        "\",\"bounds\":{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1}}}]},"
        "\"output\":{\"path\":\"glow.####.exr\"},\"quality\":{\"tolerance\":0.05,\"samples\":2}}";
    struct error error = {{0}};

    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

struct told {
    enum frame_phase phase;
    double audited; // the largest share of an audit that was told
};

static void on_phase(void *user, enum frame_phase phase)
{
    ((struct told *)user)->phase = phase;
}

static bool on_progress(void *user, double done)
{
    struct told *told = user;

    if (told->phase == FRAME_PHASE_AUDIT) told->audited = fmax(told->audited, done);
    return true;
}

// The audit of the user's code compares what is published, not a picture like it, and tells how much it has drawn.
static void an_audit_by_steps_measures_what_is_published(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct image published, finer, published_seen, finer_seen;
    struct plan_evidence evidence = {0};
    struct told told = {0};
    struct tolerance_result result;
    struct audit_result expected;
    struct plan_lattice lattice;
    struct error error = {{0}};
    enum renderer_fault fault;
    struct plan plan;
    struct job job, truth;

    (void)state;
    parse(&job);
    published = tolerance_stage_make_image(&job);
    if (!tolerance_render(stage.tolerance,
                          &(struct tolerance_params){.job = &job,
                                                     .serial = 1,
                                                     .frame = FRAME,
                                                     .image = &published,
                                                     .on_progress = on_progress,
                                                     .on_phase = on_phase,
                                                     .user = &told},
                          &result, &error))
        fail_msg("%s", error.message);
    assert_int_equal(result.retry_count, 0);
    assert_true(told.audited == 1.0);
    assert_true(plan_make(
        &plan,
        &(struct plan_params){
            .renderer = stage.gl.renderer, .job = &job, .segment = plan_segment_of(&job, FRAME), .evidence = &evidence},
        &fault, NULL));
    plan = plan_of_frame(&plan, &job, FRAME);
    assert_memory_equal(&plan.quality, &result.quality, sizeof plan.quality);
    plan_probe_init_audit(&lattice, &job, plan_evidence_find(&evidence, FRAME));
    assert_true(plan_refine(&plan, &job, PLAN_HALVING_RUNGS));
    truth = plan_apply(&plan, &job);
    truth.scene.media[0].density.glsl.lipschitz = 0.0;
    finer = render(stage.gl.renderer, &truth);
    published_seen = pick(&lattice, &published);
    finer_seen = pick(&lattice, &finer);
    audit_by_halving(&job, &published_seen, &finer_seen, &expected);
    print_message("error %.3e, expected %.3e, of %d pixels\n", result.audit.error, expected.error, expected.ray_count);
    assert_true(expected.error > 0.0 && result.audit.error == expected.error);
    assert_int_equal(result.audit.ray_count, plan_lattice_count(&lattice));
    plan_lattice_finish(&lattice);
    plan_evidence_finish(&evidence);
    image_finish(&published);
    image_finish(&finer);
    image_finish(&published_seen);
    image_finish(&finer_seen);
    job_finish(&job);
    tolerance_stage_close(stage);
}

// Four bright pixels that are in the middle of no block.
static void light_in_few_pixels_is_probed(void **state)
{
    static const struct pixel bright[] = {{0, 0}, {319, 0}, {0, 179}, {319, 179}};
    struct job job;
    struct plan_lattice lattice;
    struct image frame;

    (void)state;
    example_job_load(&job, "cloud");
    example_job_shrink(&job, 320, 180, 2.0);
    assert_true(image_init(&frame, job.width_px, job.height_px, false, false, NULL));
    memset(frame.rgba, 0, 4 * sizeof(float) * 320 * 180);
    for (size_t i = 0; i < 4; i++)
        frame.rgba[4 * (bright[i].y * 320 + bright[i].x)] = 1.0F;
    plan_probe_init_lattice(&lattice, &job, &frame);
    assert_true(plan_lattice_count(&lattice) < 320 * 180 / 4);
    for (size_t i = 0; i < 4; i++) {
        size_t at = 0;

        while (at < plan_lattice_count(&lattice) &&
               (lattice.pixels[at].x != bright[i].x || lattice.pixels[at].y != bright[i].y))
            at++;
        assert_true(at < plan_lattice_count(&lattice));
    }
    plan_lattice_finish(&lattice);
    image_finish(&frame);
    job_finish(&job);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_in_few_pixels_is_probed),
        cmocka_unit_test(what_is_to_blame_is_told_by_the_frames_own_pixels),
        cmocka_unit_test(a_march_of_scattered_light_is_judged_by_little_of_it),
        cmocka_unit_test(an_audit_by_steps_measures_what_is_published),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
