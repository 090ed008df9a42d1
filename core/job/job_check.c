// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_check.h"

#include "core/base/error.h"
#include "core/base/utf8.h"
#include "core/job/job.h"
#include "core/job/job_layers.h"
#include "core/job/job_pixels.h"
#include "core/job/scattering_check.h"
#include "core/job/step_check.h"
#include "core/json/json_read.h"
#include "core/scene/light_rules.h"
#include "core/scene/scene_nodes.h"

#include <math.h>
#include <stdio.h>

static const double PARALLEL_SIN_MIN = 1e-6;
static const double DIRECTION_LENGTH_MIN = 1e-6;
static const double WEIGHT_SUM_TOLERANCE = 1e-6;
static const double HALF_TOLERANCE_MIN = 2e-4; // rounding to half: a relative RMSE of 1.9e-4 over a power of two
static const int64_t FRAMES_CHECKED = 256;     // in a moving scene, spread evenly over the range

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

// A moving vector may pass through 0 between two nonzero values.
static bool check_direction(const struct moment *moment, const struct json_node *object, const char *key,
                            const struct timeline *timeline)
{
    struct json_node node = json_node_child(object, key);
    double direction[3];

    timeline_evaluate(timeline, moment->time, direction);
    if (length_of(direction) >= DIRECTION_LENGTH_MIN) return true;
    return json_fail(&node, moment->error, "expected a vector whose length is not 0, got one of 0%s", moment->where);
}

static bool check_cone(const struct moment *moment, const struct json_node *spot, const struct scene_light *light)
{
    struct json_node node = json_node_child(spot, "inner");
    double inner[3], outer[3];

    timeline_evaluate(&light->inner, moment->time, inner);
    timeline_evaluate(&light->outer, moment->time, outer);
    return inner[0] <= outer[0] || json_fail(&node, moment->error, "expected at most outer, %.10g degrees, got %.10g%s",
                                             outer[0], inner[0], moment->where);
}

static bool check_dome(const struct moment *moment, const struct json_node *light, const struct scene_dome *dome)
{
    struct json_node node = json_node_child(light, dome->kind == SCENE_DOME_FILE ? "rotate" : "gradient");

    return dome->kind == SCENE_DOME_RADIANCE || check_direction(moment, &node, "axis", &dome->axis);
}

static bool check_lights(const struct moment *moment)
{
    struct json_node lights = json_node_child(moment->document, "lights");

    for (size_t i = 0; i < moment->job->scene.light_count; i++) {
        const struct scene_light *light = &moment->job->scene.lights[i];
        struct json_node node = json_node_element(&lights, i);

        if (light_rules_of(light->kind)->has_direction &&
            !check_direction(moment, &node, "direction", &light->direction))
            return false;
        if (light->kind == SCENE_LIGHT_SPOT && !check_cone(moment, &node, light)) return false;
        if (light->kind == SCENE_LIGHT_DOME && !check_dome(moment, &node, &light->dome)) return false;
    }
    return true;
}

static bool check_density(const struct moment *moment, const struct json_node *medium,
                          const struct scene_density *density)
{
    struct json_node node = json_node_child(medium, "density"), bounds = json_node_child(&node, "bounds");
    struct json_node rotate = json_node_child(&node, "rotate");

    return (density->bounds.kind != SCENE_BOUNDS_SLAB ||
            check_direction(moment, &bounds, "normal", &density->bounds.normal)) &&
           (density->kind != SCENE_DENSITY_NOISE || check_direction(moment, &rotate, "axis", &density->noise.axis));
}

static bool check_media(const struct moment *moment)
{
    const struct scene *scene = &moment->job->scene;

    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct scene_medium *medium = &scene->media[i];
        struct scene_nodes nodes;
        const struct json_node *node = scene_nodes_find_medium(&nodes, moment->document, scene, i);
        struct json_node phase = json_node_child(node, "phase");
        double sum = 0.0, weight[3];

        if (!check_density(moment, node, &medium->density)) return false;
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

static bool check_objects(const struct moment *moment)
{
    const struct scene *scene = &moment->job->scene;

    for (size_t i = 0; i < scene->object_count; i++)
        for (size_t k = 0; k < scene->objects[i].shape_count; k++) {
            const struct scene_shape *shape = &scene->shapes[scene->objects[i].first_shape + k];
            struct scene_nodes nodes;
            const struct json_node *node = scene_nodes_find_shape(&nodes, moment->document, scene, i, k);

            if (shape->kind == SCENE_SHAPE_PLANE && !check_direction(moment, node, "normal", &shape->normal))
                return false;
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
        if (!check_camera(&moment) || !check_lights(&moment) || !check_media(&moment) || !check_objects(&moment))
            return false;
    }
    return true;
}

// The limits of paths between surfaces need surfaces.
static bool check_paths(const struct job *job, const struct json_node *document, struct error *error)
{
    static const char *const keys[] = {"max_depth", "min_throughput", "max_cut"};
    struct json_node quality = json_node_child(document, "quality");

    for (size_t i = 0; i < sizeof keys / sizeof keys[0] && job->scene.object_count == 0; i++) {
        struct json_node node = json_node_child(&quality, keys[i]);

        if (!json_node_is_absent(&node)) return json_fail(&node, error, "only for scenes with objects");
    }
    return true;
}

static bool check_tolerance(const struct job *job, const struct json_node *document, struct error *error)
{
    struct json_node quality = json_node_child(document, "quality");
    struct json_node node = json_node_child(&quality, "tolerance");

    return json_node_is_absent(&node) || job->output.pixel != JOB_PIXEL_HALF ||
           job->quality.tolerance >= HALF_TOLERANCE_MIN ||
           json_fail(&node, error,
                     "expected at least %g with half pixels, whose rounding errs as much, got %g; output.pixel "
                     "\"float\" errs less",
                     HALF_TOLERANCE_MIN, job->quality.tolerance);
}

// Beside paths a march shows what is seen directly; those of a part of the pixels need it.
static bool check_layers(const struct job *job, const struct json_node *document, struct error *error)
{
    const struct job seen = job_layers_seen(job);
    struct json_node quality = json_node_child(document, "quality"), step = json_node_child(&quality, "step");

    if (job->quality.pixels.stride > 0 && job->quality.step == 0.0 && job->quality.step_voxels == 0.0 &&
        !scene_media_are_even(&job->scene))
        return json_fail_expected(&step, error,
                                  "a number of metres, of the march beside paths of a part of the pixels");
    return step_check(&seen, document, error);
}

static bool check_pixels(const struct job *job, const struct json_node *document, struct error *error)
{
    struct json_node quality = json_node_child(document, "quality"), node = json_node_child(&quality, "pixels");
    const char *obstacle = job_pixels_obstacle(&job->scene, job->quality.method);

    if (job->quality.pixels.stride == 0 || !obstacle)
        return !job_layers_are_two(job) || check_layers(job, document, error);
    return json_fail(&node, error, "not with %s, which has random numbers of its own in each pixel", obstacle);
}

bool job_check(const struct job *job, const struct json_node *document, struct error *error)
{
    return check_paths(job, document, error) && check_tolerance(job, document, error) &&
           check_pixels(job, document, error) && scattering_check(job, document, error) &&
           check_moments(job, document, error) && step_check(job, document, error) &&
           scattering_check_is_rendered(job, document, error);
}

static bool check_input(const struct scene_density *density, const struct json_node *node, struct error *error)
{
    const char *path = density->kind == SCENE_DENSITY_GRID ? density->grid.file : density->glsl.file;
    struct json_node file = json_node_child(node, "file"), source = json_node_child(node, "source");

    if (path && *path != '/') return json_fail_expected(&file, error, "an absolute path");
    if (density->kind != SCENE_DENSITY_GLSL || density->glsl.source) return true;
    return json_fail_expected(&source, error, "the text of the file");
}

static bool check_texture(const struct scene_texture *texture, const struct json_node *material, struct error *error)
{
    struct json_node node = json_node_child(material, "texture"), file = json_node_child(&node, "file");

    return !texture->file || *texture->file == '/' || json_fail_expected(&file, error, "an absolute path");
}

static bool check_domes(const struct scene *scene, const struct json_node *document, struct error *error)
{
    struct json_node lights = json_node_child(document, "lights");

    for (size_t i = 0; i < scene->light_count; i++) {
        const char *path = scene->lights[i].dome.image.file;
        struct json_node light = json_node_element(&lights, i), file = json_node_child(&light, "file");

        if (path && *path != '/') return json_fail_expected(&file, error, "an absolute path");
    }
    return true;
}

bool job_check_inputs(const struct job *job, const struct json_node *document, struct error *error)
{
    const struct scene *scene = &job->scene;
    struct scene_nodes nodes;

    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct scene_density *density = &scene->media[i].density;
        const struct json_node *medium = scene_nodes_find_medium(&nodes, document, scene, i);
        struct json_node node = json_node_child(medium, "density");
        bool has_files = density->kind == SCENE_DENSITY_GRID || density->kind == SCENE_DENSITY_GLSL;

        if (has_files && !check_input(density, &node, error)) return false;
    }
    for (size_t i = 0; i < scene->object_count; i++) {
        const struct json_node *material = scene_nodes_find_material(&nodes, document, i);

        if (!check_texture(&scene->objects[i].material.texture, material, error)) return false;
    }
    return check_domes(scene, document, error);
}

static bool check_shown(const char *place, const char *text, struct error *error)
{
    const char *hidden = utf8_find_hidden(text);

    if (hidden)
        error_set(error,
                  "%s: U+%04X is not allowed: it is hidden, or moves other characters, so that people read "
                  "another name",
                  place, (unsigned)utf8_code_point(hidden));
    return !hidden;
}

bool job_check_names(const struct job *job, struct error *error)
{
    const struct output_path *path = &job->output.path;

    for (size_t i = 0; i < job->notes.tag_count; i++)
        if (!check_shown("tags", job->notes.tags[i], error)) return false;
    if (job->notes.comment && !check_shown("comment", job->notes.comment, error)) return false;
    return check_shown("name", job->name, error) && check_shown("output.path", path->folder, error) &&
           check_shown("output.path", path->prefix, error) && check_shown("output.path", path->suffix, error);
}
