// How fine a march becomes that brings light of all orders.
// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/scatter_march.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/gl_stage.h"
#include "worker/picture/image.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_params.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { COLUMNS = 16, ROWS = 12, CELLS = 4, WALKS = 12 };

// A cloud that light passes on long ways, so that coarse steps show.
static const char JOB[] =
    "{\"version\":1,\"name\":\"cloud\",\"frames\":\"0\",\"fps\":24,\"resolution\":[16,12],"
    "\"camera\":{\"position\":[0,0,4],\"target\":[0,0,0],\"fov\":33},"
    "\"lights\":[{\"kind\":\"point\",\"position\":[2,2.5,1.5],\"intensity\":20}],"
    "\"scene\":{\"scattering\":{\"orders\":\"all\"},\"media\":[{\"density\":{\"kind\":\"noise\",\"frequency\":1.5,"
    "\"octaves\":2,\"bounds\":{\"kind\":\"sphere\",\"radius\":1,\"falloff\":0.3}},\"sigma_s\":12,\"sigma_a\":0.1}]},"
    "\"quality\":{\"tolerance\":0.02},\"output\":{\"path\":\"cloud.####.exr\",\"pixel\":\"float\"}}";

struct planned {
    struct gl_stage stage;
    struct job job;
    struct plan_lattice lattice;
    struct plan_params params;
    struct plan_scene scene;
    struct plan plan; // the coarsest of its family
};

static bool marches_with_grid(const struct plan_family *family, const struct plan_scene *scene)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    bool has_steps = false, has_grid = false;

    if (family->method != JOB_METHOD_CACHED || !plan_family_serves(family, scene)) return false;
    for (int i = 0; i < plan_family_axes(family, scene, axes); i++) {
        has_steps |= axes[i] == PLAN_AXIS_STEP;
        has_grid |= axes[i] == PLAN_AXIS_SCATTER_GRID;
    }
    return has_steps && has_grid;
}

static void set_up(struct planned *planned)
{
    struct error error = {{0}};

    *planned = (struct planned){.stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL)};
    if (!job_parse(&planned->job, JOB, strlen(JOB), NULL, &error)) fail_msg("%s", error.message);
    plan_lattice_init(&planned->lattice, &planned->job, COLUMNS * ROWS);
    planned->params = (struct plan_params){
        .renderer = planned->stage.renderer, .job = &planned->job, .segment = plan_segment_at(&planned->job, 0)};
    plan_scene_init(&planned->scene, &planned->job);
    while (planned->plan.family < plan_family_count &&
           !marches_with_grid(&plan_families[planned->plan.family], &planned->scene))
        planned->plan.family++;
    assert_true(planned->plan.family < plan_family_count);
    planned->plan.quality =
        plan_family_quality(&plan_families[planned->plan.family], &planned->scene, &planned->plan.point);
}

static void tear_down(struct planned *planned)
{
    plan_lattice_finish(&planned->lattice);
    job_finish(&planned->job);
    gl_stage_close(planned->stage);
}

static struct image render(const struct planned *planned, struct plan_point point)
{
    const struct plan_family *family = &plan_families[planned->plan.family];
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    struct job job = planned->job;
    struct renderer_result result;
    struct image image = {0};
    struct error error = {{0}};

    for (int i = 0; i < plan_family_axes(family, &planned->scene, axes); i++) {
        if (axes[i] == PLAN_AXIS_SCATTER_GRID) point.rungs[i] = CELLS;
        if (axes[i] == PLAN_AXIS_NODE_PATHS) point.rungs[i] = WALKS;
    }
    job.quality = plan_family_quality(family, &planned->scene, &point);
    job.quality.samples = 1;
    if (!plan_lattice_render(&planned->lattice, &planned->params, &job, 0, &image, &result, &error))
        fail_msg("%s", error.message);
    return image;
}

static double mean_square(const struct image *a, const struct image *b)
{
    double sum = 0.0;

    for (size_t i = 0; i < (size_t)4 * COLUMNS * ROWS; i++)
        if (i % 4 != 3) sum += pow((double)a->rgba[i] - (b ? (double)b->rgba[i] : 0.0), 2.0);
    return sum / (3.0 * COLUMNS * ROWS);
}

static bool refine(const struct planned *planned, double most, struct plan *plan)
{
    struct image image = render(planned, planned->plan.point);
    enum renderer_fault fault;
    struct error error = {{0}};
    bool ok = scatter_march_refine(&(struct scatter_march_params){.lattice = &planned->lattice,
                                                                  .params = &planned->params,
                                                                  .job = &planned->job,
                                                                  .light = mean_square(&image, NULL),
                                                                  .most = most},
                                   plan, &fault, &error);

    image_finish(&image);
    return ok;
}

static bool has_refined(const struct plan *plan, const struct plan *from)
{
    bool has = false;

    for (int i = 0; i < PLAN_AXIS_LIMIT; i++)
        has |= plan->point.rungs[i] > from->point.rungs[i];
    return has;
}

// What no axis changes by more than `most` any more is that far from a march twice as fine; the coarsest is not.
static void marches_become_as_fine_as_they_show(void **state)
{
    static const double MOST = 0.01;
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    struct planned planned;
    struct plan plan;
    struct image image;
    double light;
    int count;

    set_up(&planned);
    plan = planned.plan;
    assert_true(refine(&planned, MOST, &plan));
    assert_true(has_refined(&plan, &planned.plan));
    assert_true(plan.quality.step < planned.plan.quality.step ||
                plan.quality.light_grid > planned.plan.quality.light_grid);
    image = render(&planned, plan.point);
    light = mean_square(&image, NULL);
    count = plan_family_axes(&plan_families[plan.family], &planned.scene, axes);
    for (int i = 0; i < count; i++) {
        struct plan_point finer = plan.point;
        struct image other;
        double change;

        if (axes[i] == PLAN_AXIS_SCATTER_GRID || axes[i] == PLAN_AXIS_NODE_PATHS) {
            assert_int_equal(plan.point.rungs[i], planned.plan.point.rungs[i]); // a search finds these
            continue;
        }
        finer.rungs[i] += PLAN_HALVING_RUNGS;
        if (finer.rungs[i] > plan_axis_last_rung(axes[i], &planned.scene)) continue;
        other = render(&planned, finer);
        change = sqrt(mean_square(&image, &other) / light);
        print_message("axis %d, rung %d: halved, it changes %.2e\n", axes[i], plan.point.rungs[i], change);
        assert_true(change <= 1.5 * MOST); // axes that came later have changed it a little
        image_finish(&other);
    }
    image_finish(&image);
    tear_down(&planned);
    (void)state;
}

static void what_does_not_show_stays(void **state)
{
    struct planned planned;
    struct plan plan;

    set_up(&planned);
    plan = planned.plan;
    assert_true(refine(&planned, 100.0, &plan));
    assert_false(has_refined(&plan, &planned.plan));
    tear_down(&planned);
    (void)state;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(marches_become_as_fine_as_they_show),
        cmocka_unit_test(what_does_not_show_stays),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
