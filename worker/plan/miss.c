// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/miss.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/picture/audit_result.h"
#include "worker/plan/plan_family.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SETTINGS_SIZE = 256 };

bool miss_has_promise(const struct scene_density *density)
{
    return density->kind == SCENE_DENSITY_GLSL && density->glsl.lipschitz > 0.0;
}

// Writes the numbers of the quality that are set, by their keys in a job.
static void format_settings(const struct job *job, const struct job_quality *quality, char text[static SETTINGS_SIZE])
{
    const struct {
        const char *key;
        double number;
    } settings[] = {{"step", quality->step},
                    {"step_voxels", quality->step_voxels},
                    {"light_step", quality->light_step},
                    {"light_step_voxels", quality->light_step_voxels},
                    {"depth_step", quality->depth_step},
                    {"points", quality->points},
                    {"light_grid", quality->light_grid},
                    {"density_grid", quality->density_grid},
                    {"scatter_grid", quality->scatter_grid},
                    {"paths", quality->paths},
                    {"similar_after", quality->similar_after},
                    {"min_transmittance", quality->min_transmittance},
                    {"max_depth", job->scene.object_count > 0 ? quality->max_depth : 0}};
    int length = snprintf(text, SETTINGS_SIZE, "%s", job_method_name(quality->method));

    for (size_t i = 0; i < sizeof settings / sizeof *settings && length < SETTINGS_SIZE; i++) {
        if (settings[i].number == 0.0) continue;
        // Numbers of paths are powers of two, and whole.
        length += snprintf(text + length, SETTINGS_SIZE - (size_t)length, ", %s %.*g", settings[i].key,
                           settings[i].number == round(settings[i].number) ? 9 : 3, settings[i].number);
    }
    if (quality->scatter_from == JOB_SCATTER_FROM_LIGHTS && length < SETTINGS_SIZE)
        snprintf(text + length, SETTINGS_SIZE - (size_t)length, ", scatter_from lights");
}

static bool promises(const struct scene *scene)
{
    for (size_t i = 0; i < scene->medium_count; ++i)
        if (miss_has_promise(&scene->media[i].density)) return true;
    return false;
}

void miss_describe_retry(const struct plan *before, double error, const struct plan *plan,
                         char reason[static PLAN_REASON_SIZE])
{
    const char *name = plan_families[plan->family].name, *name_before = plan_families[before->family].name;

    if (isinf(error))
        snprintf(reason, PLAN_REASON_SIZE, "%s, rendered again: GL cut the loops of %s", name, name_before);
    else
        snprintf(reason, PLAN_REASON_SIZE, "%s, rendered again: by %s, the error was %.2e", name, name_before, error);
}

void miss_describe(const struct miss *miss, struct error *error)
{
    char settings[SETTINGS_SIZE], first[32] = "was cut by GL", got[96];
    const struct audit_result *audit = miss->audit;

    // Chance makes an estimate vanish, too.
    if (miss->first_error > 0.0 && !isinf(miss->first_error))
        snprintf(first, sizeof first, "had %.3g", miss->first_error);
    else if (miss->first_error <= 0.0)
        snprintf(first, sizeof first, "had no clear one");
    if (audit->error > 0.0)
        snprintf(got, sizeof got, "%.3g (give or take %.2g, with confidence below %.3g)", audit->error, audit->spread,
                 audit->error95);
    else
        snprintf(got, sizeof got, "one of at most %.3g (with confidence)", audit->error95);
    format_settings(miss->job, miss->quality, settings);
    error_set(error,
              "quality.tolerance: expected an error of at most %g, got %s at best, by %s; "
              "the first of %d renderings %s, and all took %.3g times its work%s; expected a larger tolerance, a "
              "method with finer numbers, or \"on_miss\": \"publish\"",
              miss->job->quality.tolerance, got, settings, miss->rendering_count, first, miss->work,
              promises(&miss->job->scene) ? " (is a density.lipschitz too low?)" : "");
}
