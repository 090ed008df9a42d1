// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/integrators.h"

#include "core/job/job.h"
#include "worker/model/scene_model.h"

static bool is_riemann(const struct scene_model *model)
{
    return model->job->quality.method == JOB_METHOD_RIEMANN;
}

static bool is_tracked_by(const struct scene_model *model, enum job_estimator estimator)
{
    return model->features.is_tracked && model->job->quality.estimator == estimator;
}

static bool is_delta(const struct scene_model *model)
{
    return is_tracked_by(model, JOB_ESTIMATOR_DELTA);
}

static bool is_ratio(const struct scene_model *model)
{
    return is_tracked_by(model, JOB_ESTIMATOR_RATIO);
}

static bool is_debiased(const struct scene_model *model)
{
    return is_tracked_by(model, JOB_ESTIMATOR_DEBIASED);
}

static bool is_jackknife(const struct scene_model *model)
{
    return is_tracked_by(model, JOB_ESTIMATOR_JACKKNIFE);
}

static bool is_jittered(const struct scene_model *model)
{
    return model->features.is_jittered;
}

static bool is_tabled(const struct scene_model *model)
{
    return model->features.is_tabled;
}

static bool is_adaptive(const struct scene_model *model)
{
    return model->features.is_adaptive;
}

static bool is_gauss(const struct scene_model *model)
{
    return model->features.is_gauss;
}

static bool marches(const struct scene_model *model)
{
    return model->features.marches;
}

static bool always(const struct scene_model *model)
{
    (void)model;
    return true;
}

static void write_riemann(FILE *out, const struct scene_model *model)
{
    fprintf(out, "%.9e, quality_step, int(quality_step_count)", model->job->scene.camera.clip_near);
}

static void write_light_steps(FILE *out, const struct scene_model *model)
{
    (void)model;
    fputs("int(quality_light_steps)", out);
}

// n spans have 2 n ends.
static void write_stretches(FILE *out, const struct scene_model *model)
{
    fprintf(out, "%zu", 2 * model->features.medium_count);
}

static const struct integrator_part closed = {"transmittance/closed.glsl", "transmittance_closed(", NULL};
static const struct integrator_part cached = {"transmittance/cached.glsl", "transmittance_cached(", NULL};

static const struct integrator integrators[] = {
    {is_riemann,
     {"integrator/riemann.glsl", "integrator_riemann(IntegratorRiemann(", write_riemann},
     {"transmittance/riemann.glsl", "transmittance_riemann(TransmittanceRiemann(", write_light_steps}},
    {is_delta,
     {"integrator/delta.glsl", "integrator_delta(IntegratorDelta(TRACKING_SAMPLES", NULL},
     {"transmittance/delta.glsl", "transmittance_delta(", NULL}},
    {is_ratio,
     {"integrator/ratio.glsl", "integrator_ratio(IntegratorRatio(TRACKING_SAMPLES", NULL},
     {"transmittance/ratio.glsl", "transmittance_ratio(", NULL}},
    {is_debiased,
     {"integrator/estimated.glsl", "integrator_estimated(IntegratorEstimated(quality_step", NULL},
     {"transmittance/debiased.glsl", "transmittance_debiased(", NULL}},
    {is_jackknife,
     {"integrator/estimated.glsl", "integrator_estimated(IntegratorEstimated(quality_step", NULL},
     {"transmittance/jackknife.glsl", "transmittance_jackknife(", NULL}},
    {is_jittered,
     {"integrator/jittered.glsl", "integrator_jittered(IntegratorJittered(quality_step", NULL},
     {"transmittance/jittered.glsl", "transmittance_jittered(TransmittanceJittered(quality_light_step", NULL}},
    {is_tabled,
     {"integrator/preintegrated.glsl", "integrator_preintegrated(IntegratorPreintegrated(quality_step", NULL},
     {"transmittance/midpoint.glsl", "transmittance_midpoint(TransmittanceMidpoint(quality_light_step", NULL}},
    {is_adaptive,
     {"integrator/adaptive.glsl", "integrator_adaptive(IntegratorAdaptive(quality_step, quality_depth_step", NULL},
     {"transmittance/adaptive.glsl",
      "transmittance_adaptive(TransmittanceAdaptive(quality_light_step, quality_depth_step", NULL}},
    {is_gauss,
     {"integrator/gauss.glsl", "integrator_gauss(IntegratorGauss(quality_step", NULL},
     {"transmittance/gauss.glsl", "transmittance_gauss(TransmittanceGauss(quality_light_step", NULL}},
    {marches,
     {"integrator/midpoint.glsl", "integrator_midpoint(IntegratorMidpoint(quality_step", NULL},
     {"transmittance/midpoint.glsl", "transmittance_midpoint(TransmittanceMidpoint(quality_light_step", NULL}},
    {always,
     {"integrator/stretches.glsl", "integrator_stretches(IntegratorStretches(", write_stretches},
     {NULL, NULL, NULL}},
};

const struct integrator *integrator_of(const struct scene_model *model)
{
    const struct integrator *integrator = integrators;

    while (!integrator->applies(model))
        ++integrator;
    return integrator;
}

const struct integrator_part *integrator_to_lights(const struct scene_model *model)
{
    if (model->features.is_tracked) return &integrator_of(model)->to_lights;
    if (!model->features.marches_to_lights) return &closed;
    return model->features.has_light_grids ? &cached : &integrator_of(model)->to_lights;
}

void integrator_write_call(FILE *out, const struct integrator_part *part, const struct scene_model *model)
{
    fputs(part->call, out);
    if (part->write_parameters) part->write_parameters(out, model);
    fputs(")", out);
}
