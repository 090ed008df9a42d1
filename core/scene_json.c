#include "core/scene_json.h"

#include "core/error.h"
#include "core/job_later.h"
#include "core/scene.h"
#include "core/timeline_json.h"

#include <math.h>
#include <string.h>

static const double DISTANCE_MAX = 1e9; // m

static const struct timeline_limits POSITION = {.components = 3, .min = -1e9, .max = 1e9, .is_position = true};
static const struct timeline_limits DIRECTION = {.components = 3, .min = -1e9, .max = 1e9, .is_direction = true};
static const struct timeline_limits FOV = {
    .components = 1, .min = 0.0, .max = 180.0, .excludes_min = true, .excludes_max = true};
static const struct timeline_limits RADIANCE = {.min = 0.0, .max = 1e15};
static const struct timeline_limits COEFFICIENT = {.min = 0.0, .max = 1e9};
static const struct timeline_limits LENGTH = {.components = 1, .min = 0.0, .max = 1e9};
static const struct timeline_limits ANGLE = {.components = 1, .min = -1e9, .max = 1e9};
static const struct timeline_limits EXPONENT = {.components = 1, .min = 0.0, .max = 100.0, .excludes_min = true};
static const struct timeline_limits SCALE = {.components = 1, .min = 0.0, .max = 1e9};
// Beyond it, 1 - |g| has too few digits in a shader's float.
static const struct timeline_limits COSINE = {.components = 1, .min = -0.99999, .max = 0.99999};
static const struct timeline_limits SHARE = {.components = 1, .min = 0.0, .max = 1.0};

// Where the reader stands: an object, and what holds for all of the document.
struct reader {
    const struct json_node *object;
    struct timeline_span span;
    struct error *error;
};

static bool read_timeline(const struct reader *reader, const char *key, const struct timeline_limits *limits,
                          struct timeline *timeline)
{
    struct json_node node = json_node_child(reader->object, key);
    struct timeline_limits within = *limits;

    within.span = reader->span;
    return timeline_from_json(timeline, &node, &within, reader->error);
}

static bool has_key(const struct reader *reader, const char *key)
{
    struct json_node node = json_node_child(reader->object, key);

    return !json_node_is_absent(&node);
}

// An absent one is the number 0.
static bool read_optional(const struct reader *reader, const char *key, const struct timeline_limits *limits,
                          struct timeline *timeline)
{
    *timeline = (struct timeline){.component_count = limits->components == 3 ? 3 : 1};
    return !has_key(reader, key) || read_timeline(reader, key, limits, timeline);
}

static bool read_clip(const struct reader *reader, struct scene_camera *camera)
{
    struct json_node clip = json_node_child(reader->object, "clip");
    struct json_node near = json_node_element(&clip, 0), far = json_node_element(&clip, 1);

    camera->clip_near = 0.0;
    camera->clip_far = INFINITY;
    if (json_node_is_absent(&clip)) return true;
    if (json_node_type(&clip) != JSON_ARRAY || json_node_count(&clip) != 2)
        return json_fail_expected(&clip, reader->error, "[near, far] in metres");
    if (!json_read_number(&near, 0.0, DISTANCE_MAX, &camera->clip_near, reader->error) ||
        !json_read_number(&far, 0.0, DISTANCE_MAX, &camera->clip_far, reader->error))
        return false;
    if (camera->clip_near < camera->clip_far) return true;
    return json_fail(&clip, reader->error, "expected near < far, got %.10g and %.10g", camera->clip_near,
                     camera->clip_far);
}

static bool read_camera(const struct reader *job, struct scene_camera *camera)
{
    static const char *const keys[] = {"position", "target", "up", "fov", "clip", "mirror", "shutter", NULL};
    struct json_node object = json_node_child(job->object, "camera");
    struct reader reader = {&object, job->span, job->error};
    struct json_node mirror = json_node_child(&object, "mirror");

    if (!json_check_object(&object, job->error) || !json_check_keys(&object, keys, job->error) ||
        !job_later_check(&object, JOB_LATER_CAMERA, job->error))
        return false;
    camera->up = (struct timeline){.component_count = 3, .value = {0.0, 1.0, 0.0}};
    if (has_key(&reader, "up") && !read_timeline(&reader, "up", &DIRECTION, &camera->up)) return false;
    return read_timeline(&reader, "position", &POSITION, &camera->position) &&
           read_timeline(&reader, "target", &POSITION, &camera->target) &&
           read_timeline(&reader, "fov", &FOV, &camera->fov) && read_clip(&reader, camera) &&
           (json_node_is_absent(&mirror) || json_read_bool(&mirror, &camera->mirror, job->error));
}

static bool read_point_light(const struct reader *reader, struct scene_light *light)
{
    static const char *const keys[] = {"kind", "falloff", "intensity", "position", NULL};
    static const char *const falloffs[] = {"inverse_square", "none", NULL};
    struct json_node falloff = json_node_child(reader->object, "falloff");
    int choice = SCENE_FALLOFF_INVERSE_SQUARE;

    if (!json_check_keys(reader->object, keys, reader->error)) return false;
    if (!json_node_is_absent(&falloff) && !json_read_enum(&falloff, falloffs, &choice, reader->error)) return false;
    light->falloff = (enum scene_falloff)choice;
    light->direction = (struct timeline){.component_count = 3};
    return read_timeline(reader, "intensity", &RADIANCE, &light->intensity) &&
           read_timeline(reader, "position", &POSITION, &light->position);
}

static bool read_sun_light(const struct reader *reader, struct scene_light *light)
{
    static const char *const keys[] = {"kind", "intensity", "direction", NULL};

    light->position = (struct timeline){.component_count = 3};
    return json_check_keys(reader->object, keys, reader->error) &&
           read_timeline(reader, "intensity", &RADIANCE, &light->intensity) &&
           read_timeline(reader, "direction", &DIRECTION, &light->direction);
}

static bool read_light(const struct reader *reader, struct scene_light *light)
{
    static const char *const kinds[] = {"point", "sun", NULL};
    struct json_node kind = json_node_child(reader->object, "kind");
    int choice;

    if (!json_check_object(reader->object, reader->error) || !json_read_enum(&kind, kinds, &choice, reader->error))
        return false;
    light->kind = (enum scene_light_kind)choice;
    return light->kind == SCENE_LIGHT_POINT ? read_point_light(reader, light) : read_sun_light(reader, light);
}

static bool read_density(const struct reader *medium, struct scene_density *density)
{
    static const char *const kinds[] = {"fold_fractal", NULL};
    static const char *const keys[] = {"kind",         "iterations", "offset", "radius", "rotate_x_rad",
                                       "rotate_y_rad", "exponent",   "scale",  NULL};
    struct json_node object = json_node_child(medium->object, "density");
    struct reader reader = {&object, medium->span, medium->error};
    struct json_node kind = json_node_child(&object, "kind"), iterations = json_node_child(&object, "iterations");
    struct scene_fold_fractal *fold_fractal = &density->fold_fractal;
    int64_t count;
    int choice;

    if (!json_check_object(&object, medium->error) || !job_later_check(&object, JOB_LATER_DENSITY, medium->error) ||
        !json_read_enum(&kind, kinds, &choice, medium->error) || !json_check_keys(&object, keys, medium->error))
        return false;
    density->kind = (enum scene_density_kind)choice;
    if (!json_read_integer(&iterations, 1, SCENE_ITERATION_LIMIT, &count, medium->error)) return false;
    fold_fractal->iterations = (int)count;
    return read_timeline(&reader, "offset", &LENGTH, &fold_fractal->offset) &&
           read_timeline(&reader, "radius", &LENGTH, &fold_fractal->radius) &&
           read_optional(&reader, "rotate_x_rad", &ANGLE, &fold_fractal->rotate_x_rad) &&
           read_optional(&reader, "rotate_y_rad", &ANGLE, &fold_fractal->rotate_y_rad) &&
           read_timeline(&reader, "exponent", &EXPONENT, &fold_fractal->exponent) &&
           read_timeline(&reader, "scale", &SCALE, &fold_fractal->scale);
}

static bool read_lobe(const struct reader *reader, struct scene_phase_lobe *lobe)
{
    static const char *const kinds[] = {"henyey_greenstein", NULL};
    static const char *const keys[] = {"kind", "g", "weight", NULL};
    struct json_node kind = json_node_child(reader->object, "kind");
    int choice;

    if (!json_check_object(reader->object, reader->error) ||
        !job_later_check(reader->object, JOB_LATER_PHASE, reader->error) ||
        !json_check_keys(reader->object, keys, reader->error))
        return false;
    if (!json_node_is_absent(&kind) && !json_read_enum(&kind, kinds, &choice, reader->error)) return false;
    lobe->weight = (struct timeline){.component_count = 1, .value = {1.0}};
    return read_timeline(reader, "g", &COSINE, &lobe->g) &&
           (!has_key(reader, "weight") || read_timeline(reader, "weight", &SHARE, &lobe->weight));
}

static bool read_phase(const struct reader *medium, struct scene_medium *read)
{
    struct json_node lobes = json_node_child(medium->object, "phase"), lobe = {0};
    struct reader reader = {&lobe, medium->span, medium->error};

    if (json_node_is_absent(&lobes)) return true;
    if (!json_check_array(&lobes, 1, SCENE_LOBE_LIMIT, medium->error)) return false;
    while (json_node_next(&lobes, &lobe))
        if (!read_lobe(&reader, &read->lobes[read->lobe_count++])) return false;
    return true;
}

static bool read_medium(const struct reader *reader, struct scene_medium *medium)
{
    static const char *const keys[] = {"density", "sigma_s", "sigma_a", "emission", "phase", NULL};

    if (!json_check_object(reader->object, reader->error) || !json_check_keys(reader->object, keys, reader->error))
        return false;
    medium->has_emission = has_key(reader, "emission");
    if (!medium->has_emission && !has_key(reader, "sigma_s") && !has_key(reader, "sigma_a"))
        return json_fail(reader->object, reader->error, "expected sigma_s, sigma_a or emission, got none of them");
    return read_density(reader, &medium->density) && read_optional(reader, "sigma_s", &COEFFICIENT, &medium->sigma_s) &&
           read_optional(reader, "sigma_a", &COEFFICIENT, &medium->sigma_a) &&
           read_optional(reader, "emission", &RADIANCE, &medium->emission) && read_phase(reader, medium);
}

static bool read_lights(const struct reader *job, struct scene *scene)
{
    struct json_node lights = json_node_child(job->object, "lights"), light = {0};
    struct reader reader = {&light, job->span, job->error};

    if (json_node_is_absent(&lights)) return true;
    if (!json_check_array(&lights, 0, SCENE_LIGHT_LIMIT, job->error)) return false;
    while (json_node_next(&lights, &light))
        if (!read_light(&reader, &scene->lights[scene->light_count++])) return false;
    return true;
}

static bool read_media(const struct reader *job, struct scene *scene)
{
    static const char *const keys[] = {"media", "objects", NULL};
    struct json_node object = json_node_child(job->object, "scene");
    struct json_node media = json_node_child(&object, "media"), medium = {0};
    struct reader reader = {&medium, job->span, job->error};

    if (json_node_is_absent(&object)) return true;
    if (!json_check_object(&object, job->error) || !json_check_keys(&object, keys, job->error) ||
        !job_later_check(&object, JOB_LATER_SCENE, job->error))
        return false;
    if (json_node_is_absent(&media)) return true;
    if (!json_check_array(&media, 0, SCENE_MEDIUM_LIMIT, job->error)) return false;
    while (json_node_next(&media, &medium))
        if (!read_medium(&reader, &scene->media[scene->medium_count++])) return false;
    return true;
}

bool scene_from_json(struct scene *scene, const struct json_node *job, struct timeline_span span, struct error *error)
{
    struct reader reader = {job, span, error};

    *scene = (struct scene){0};
    scene->has_background = has_key(&reader, "background");
    return read_camera(&reader, &scene->camera) && read_lights(&reader, scene) &&
           read_optional(&reader, "background", &RADIANCE, &scene->background) && read_media(&reader, scene);
}
