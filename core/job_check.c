#include "core/job_check.h"

#include "core/error.h"
#include "core/job.h"
#include "core/json_read.h"

#include <math.h>
#include <stdio.h>

static const double PARALLEL_SIN_MIN = 1e-6;
static const double DIRECTION_LENGTH_MIN = 1e-6;
static const double WEIGHT_SUM_TOLERANCE = 1e-6;
static const int64_t FRAMES_CHECKED = 256; // of a moving scene, evenly over the range

struct moment {
    const struct job *job;
    const struct json_node *document;
    double time;    // s
    char where[48]; // " at frame 12", or empty when nothing moves
    struct error *error;
};

static double length_of(const double vector[3])
{
    return hypot(hypot(vector[0], vector[1]), vector[2]);
}

static bool check_camera(const struct moment *moment)
{
    const struct scene_camera *camera = &moment->job->scene.camera;
    struct json_node node = json_node_child(moment->document, "camera");
    struct json_node target_node = json_node_child(&node, "target"), up_node = json_node_child(&node, "up");
    double position[3], target[3], up[3], forward[3], cross[3], up_length;

    timeline_evaluate(&camera->position, moment->time, position);
    timeline_evaluate(&camera->target, moment->time, target);
    timeline_evaluate(&camera->up, moment->time, up);
    for (int i = 0; i < 3; i++)
        forward[i] = target[i] - position[i];
    if (length_of(forward) < DIRECTION_LENGTH_MIN)
        return json_fail(&target_node, moment->error, "expected a point other than camera.position, got the same%s",
                         moment->where);
    up_length = length_of(up);
    if (up_length < DIRECTION_LENGTH_MIN)
        return json_fail(&up_node, moment->error, "expected a vector whose length is not 0, got one of 0%s",
                         moment->where);
    cross[0] = forward[1] * up[2] - forward[2] * up[1];
    cross[1] = forward[2] * up[0] - forward[0] * up[2];
    cross[2] = forward[0] * up[1] - forward[1] * up[0];
    if (length_of(cross) >= PARALLEL_SIN_MIN * up_length * length_of(forward)) return true;
    return json_fail(&up_node, moment->error, "expected a direction that is not along the view, got a parallel one%s",
                     moment->where);
}

static bool check_lights(const struct moment *moment)
{
    struct json_node lights = json_node_child(moment->document, "lights");
    double direction[3];

    for (size_t i = 0; i < moment->job->scene.light_count; i++) {
        struct json_node light = json_node_element(&lights, i), node = json_node_child(&light, "direction");

        if (moment->job->scene.lights[i].kind != SCENE_LIGHT_SUN) continue;
        timeline_evaluate(&moment->job->scene.lights[i].direction, moment->time, direction);
        if (length_of(direction) < DIRECTION_LENGTH_MIN)
            return json_fail(&node, moment->error, "expected a vector whose length is not 0, got one of 0%s",
                             moment->where);
    }
    return true;
}

static bool check_weights(const struct moment *moment)
{
    struct json_node scene = json_node_child(moment->document, "scene"), media = json_node_child(&scene, "media");

    for (size_t i = 0; i < moment->job->scene.medium_count; i++) {
        const struct scene_medium *medium = &moment->job->scene.media[i];
        struct json_node node = json_node_element(&media, i), phase = json_node_child(&node, "phase");
        double sum = 0.0, weight[3];

        for (size_t k = 0; k < medium->lobe_count; k++) {
            timeline_evaluate(&medium->lobes[k].weight, moment->time, weight);
            sum += weight[0];
        }
        if (medium->lobe_count > 0 && fabs(sum - 1.0) > WEIGHT_SUM_TOLERANCE)
            return json_fail(&phase, moment->error, "expected weights that sum to 1, got a sum of %.10g%s", sum,
                             moment->where);
    }
    return true;
}

static bool check_moments(const struct job *job, const struct json_node *document, struct error *error)
{
    int64_t count = frame_range_count(&job->frames);
    int64_t checked = count < FRAMES_CHECKED ? count : FRAMES_CHECKED;
    bool moves = !scene_is_constant(&job->scene);

    if (!moves) checked = 1;
    for (int64_t i = 0; i < checked; i++) {
        int32_t frame = frame_range_at(&job->frames, checked > 1 ? i * (count - 1) / (checked - 1) : 0);
        struct moment moment = {job, document, job_frame_time(job, frame), "", error};

        if (moves) snprintf(moment.where, sizeof moment.where, " at frame %d", frame);
        if (!check_camera(&moment) || !check_lights(&moment) || !check_weights(&moment)) return false;
    }
    return true;
}

// The longest way through the medium, m.
static double medium_diameter(const struct scene_medium *medium, struct timeline_span span)
{
    const struct scene_fold_fractal *fold_fractal = &medium->density.fold_fractal;
    double min[3], radius[3], offset[3];

    timeline_find_bounds(&fold_fractal->radius, span, min, radius);
    timeline_find_bounds(&fold_fractal->offset, span, min, offset);
    return 2.0 * (radius[0] + fold_fractal->iterations * sqrt(3.0) * offset[0]);
}

static bool check_steps(const struct json_node *node, double length, double step, const char *along,
                        struct error *error)
{
    double count = ceil(length / step - 1e-9);

    if (count <= JOB_MARCH_STEPS_LIMIT) return true;
    return json_fail(node, error, "expected at most %d steps along a ray, got %.10g: %.10g m %s in steps of %.10g m",
                     JOB_MARCH_STEPS_LIMIT, count, length, along, step);
}

static bool check_riemann(const struct job *job, const struct json_node *quality, struct error *error)
{
    const struct scene_camera *camera = &job->scene.camera;
    struct json_node step = json_node_child(quality, "step"), method = json_node_child(quality, "method");
    double length = camera->clip_far - camera->clip_near;

    if (!isfinite(length))
        return json_fail(&method, error, "riemann needs camera.clip: it steps from the near to the far distance");
    if (round(length / job->quality.step) < 1.0)
        return json_fail(&step, error, "expected at most the %.10g m between the clip distances, got %.10g", length,
                         job->quality.step);
    return check_steps(&step, length, job->quality.step, "between the clip distances", error);
}

static bool check_midpoint(const struct job *job, const struct json_node *quality, struct error *error)
{
    const struct scene_camera *camera = &job->scene.camera;
    struct json_node step = json_node_child(quality, "step"), light_step = json_node_child(quality, "light_step");
    char along[48];

    for (size_t i = 0; i < job->scene.medium_count; i++) {
        double diameter = medium_diameter(&job->scene.media[i], job_time_span(job));
        double length = fmin(diameter, camera->clip_far - camera->clip_near);

        snprintf(along, sizeof along, "through scene.media[%zu]", i);
        if (!check_steps(&step, length, job->quality.step, along, error) ||
            (job->scene.light_count > 0 && !check_steps(&light_step, diameter, job->quality.light_step, along, error)))
            return false;
    }
    return true;
}

bool job_check(const struct job *job, const struct json_node *document, struct error *error)
{
    struct json_node quality = json_node_child(document, "quality");

    if (!check_moments(job, document, error)) return false;
    switch (job->quality.method) {
    case JOB_METHOD_RIEMANN:
        return check_riemann(job, &quality, error);
    case JOB_METHOD_MIDPOINT:
        return check_midpoint(job, &quality, error);
    case JOB_METHOD_EQUIANGULAR:
        return true;
    }
    return false;
}
