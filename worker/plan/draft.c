// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/draft.h"

#include "core/base/error.h"
#include "core/job/step_check.h"
#include "core/json/json_read.h"
#include "worker/plan/plan_family.h"

#include <stdio.h>
#include <string.h>

const double DRAFT_EVALUATIONS = 600.0;

// An optical depth at which no ray ends early: the count is then an upper bound.
static const float CLEAR = 1.0f;

// The rungs at which methods are compared: 64 steps along the longest path, or more where a medium is small beside it,
// half as many towards lights, and grids whose cells are about as long as these steps.
static int middle_rung(enum plan_axis axis, const struct plan_scene *scene)
{
    switch (axis) {
    case PLAN_AXIS_STEP:
        return 4 + 2 * scene->small_level;
    case PLAN_AXIS_LIGHT_STEP:
        return 2 + 2 * scene->small_level;
    case PLAN_AXIS_DEPTH_STEP:
        return 4;
    case PLAN_AXIS_POINTS:
        return 6;
    case PLAN_AXIS_LIGHT_GRID:
        return 5;
    case PLAN_AXIS_DENSITY_GRID:
        return 6;
    case PLAN_AXIS_MIN_TRANSMITTANCE:
        return 3;
    case PLAN_AXIS_SCATTER_GRID:
        return 4;
    case PLAN_AXIS_PIXEL_PATHS:
        return 8;
    case PLAN_AXIS_NODE_PATHS:
        return 10;
    case PLAN_AXIS_PATHS: // the job's own
        break;
    }
    return 0;
}

static struct plan_scene scene_of(const struct job *job)
{
    int32_t first = frame_range_at(&job->frames, 0);
    struct plan_scene scene;

    plan_scene_init(&scene, job);
    // Beside a path that is far longer than all that is dense, most of its steps are never taken.
    if (scene.small_level > 0) plan_scene_measure_lengths(&scene, &first, 1);
    scene.depths = &CLEAR;
    scene.depth_count = 1;
    scene.hit_share = 1.0;
    return scene;
}

// Axes on whose rungs the count does not depend: they stay in the middle.
static bool is_free(enum plan_axis axis)
{
    return axis == PLAN_AXIS_MIN_TRANSMITTANCE || axis == PLAN_AXIS_PATHS;
}

// The family's settings, every axis `finer` rungs above the middle; below its coarsest rung an axis stays there.
static struct job_quality settings_at(const struct plan_family *family, const struct plan_scene *scene, int finer)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count = plan_family_axes(family, scene, axes);
    struct plan_point point = {.rungs = {0}};

    for (int i = 0; i < count; i++) {
        int last = plan_axis_last_rung(axes[i], scene),
            rung = middle_rung(axes[i], scene) + (is_free(axes[i]) ? 0 : finer);

        point.rungs[i] = rung < 0 ? 0 : rung > last ? last : rung;
    }
    return plan_family_quality(family, scene, &point);
}

static bool is_legal(const struct job *job, const struct job_quality *quality)
{
    struct json_node nowhere = json_node_root(NULL);
    struct job settled = *job;

    settled.quality = *quality;
    return step_check(&settled, &nowhere, NULL);
}

// The finest settings of the family within the limit; if none is, the coarsest.
static struct job_quality find_settings(const struct plan_family *family, const struct plan_scene *scene)
{
    enum { FINEST = 12, COARSEST = -6 };

    for (int finer = FINEST; finer > COARSEST; finer--) {
        struct job_quality quality = settings_at(family, scene, finer);

        if (plan_family_work(scene, &quality) <= DRAFT_EVALUATIONS && is_legal(scene->job, &quality)) return quality;
    }
    return settings_at(family, scene, COARSEST);
}

// Adds a family behind those that take no more work.
static void add_option(struct draft *draft, size_t families[static DRAFT_FAMILY_LIMIT], size_t family,
                       const struct plan_scene *scene)
{
    struct job_quality quality = settings_at(&plan_families[family], scene, 0);
    double evaluations = plan_family_work(scene, &quality);
    size_t at = draft->option_count++;

    for (; at > 0 && draft->options[at - 1].evaluations > evaluations; at--) {
        draft->options[at] = draft->options[at - 1];
        families[at] = families[at - 1];
    }
    draft->options[at] = (struct draft_option){plan_families[family].name, evaluations};
    families[at] = family;
}

bool draft_choose(struct draft *draft, const struct job *job, struct error *error)
{
    struct job sampled = *job;
    struct plan_scene scene;
    size_t families[DRAFT_FAMILY_LIMIT];

    *draft = (struct draft){0};
    sampled.quality.samples = 1;
    scene = scene_of(&sampled);
    for (size_t i = 0; i < plan_family_count && draft->option_count < DRAFT_FAMILY_LIMIT; i++)
        if (plan_family_serves(&plan_families[i], &scene)) add_option(draft, families, i, &scene);
    if (draft->option_count == 0) {
        error_set(error, "quality: no draft can be made of this scene; expected a method with its numbers");
        return false;
    }
    draft->quality = find_settings(&plan_families[families[0]], &scene);
    draft->quality.is_draft = true; // also in place of a tolerance
    draft->quality.tolerance = 0.0;
    draft->quality.max_cut = 1.0;
    draft->evaluations = plan_family_work(&scene, &draft->quality);
    snprintf(draft->reason, sizeof draft->reason,
             "a draft: %s takes the fewest evaluations of densities by count, and here %.0f a pixel at most",
             draft->options[0].name, draft->evaluations);
    return true;
}

bool draft_settle(struct job *job, char reason[IMAGE_EXR_PLAN_SIZE], struct error *error)
{
    struct draft draft;

    if (job->quality.method != JOB_METHOD_DRAFT) return true;
    if (!draft_choose(&draft, job, error)) return false;
    job->quality = draft.quality;
    if (reason) memcpy(reason, draft.reason, sizeof draft.reason);
    return true;
}

double draft_count(const struct job *job)
{
    struct plan_scene scene = scene_of(job);

    if (job->quality.method == JOB_METHOD_RIEMANN || job->quality.method == JOB_METHOD_TRACKING ||
        job->quality.method == JOB_METHOD_PATHS)
        return 0.0;
    return plan_family_work(&scene, &job->quality);
}
