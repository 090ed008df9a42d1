#include "worker/scene_values.h"

#include "core/job.h"
#include "worker/camera_view.h"
#include "worker/frame_uniforms.h"
#include "worker/scene_features.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

// Rounding to float may take the ball this much too small.
static const double ball_margin = 1 + 1e-6;
static const double largest_g = 0.99999;

static void evaluate_timeline(const void *source, double time, double value[static 9])
{
    const struct timeline *timeline = source;

    timeline_evaluate(timeline, time, value);
    if (timeline->component_count == 1) value[1] = value[2] = value[0];
}

static void evaluate_sigma_t(const void *source, double time, double value[static 9])
{
    const struct scene_medium *medium = source;
    double sigma_s[9] = {0}, sigma_a[9] = {0};

    evaluate_timeline(&medium->sigma_s, time, sigma_s);
    evaluate_timeline(&medium->sigma_a, time, sigma_a);
    for (int i = 0; i < 3; ++i)
        value[i] = sigma_s[i] + sigma_a[i];
}

// About x first, then about y; column-major.
static void evaluate_rotation(const void *source, double time, double value[static 9])
{
    const struct scene_fold_fractal *fractal = source;
    double x[9] = {0}, y[9] = {0};

    evaluate_timeline(&fractal->rotate_x_rad, time, x);
    evaluate_timeline(&fractal->rotate_y_rad, time, y);
    {
        double cx = cos(x[0]), sx = sin(x[0]), cy = cos(y[0]), sy = sin(y[0]);
        double rotation[9] = {cy, 0, -sy, sy * sx, cx, cy * sx, sy * cx, -sx, cy * cx};

        memcpy(value, rotation, sizeof rotation);
    }
}

static void evaluate_toward_sun(const void *source, double time, double value[static 9])
{
    double length;

    evaluate_timeline(source, time, value);
    length = hypot(hypot(value[0], value[1]), value[2]);
    for (int i = 0; i < 3; ++i)
        value[i] /= -length;
}

static void evaluate_ball_radius(const void *source, double time, double value[static 9])
{
    const struct scene *scene = source;

    value[0] = 0;
    for (size_t i = 0; i < scene->medium_count; ++i) {
        const struct scene_fold_fractal *fractal = &scene->media[i].density.fold_fractal;
        double offset[9] = {0}, radius[9] = {0};

        evaluate_timeline(&fractal->offset, time, offset);
        evaluate_timeline(&fractal->radius, time, radius);
        value[0] = fmax(value[0], (radius[0] + fractal->iterations * sqrt(3) * fabs(offset[0])) * ball_margin);
    }
}

static void evaluate_camera_position(const void *source, double time, double value[static 9])
{
    const struct job *job = source;

    timeline_evaluate(&job->scene.camera.position, time, value);
}

// scale_right and scale_up times the image's axes, plus `ahead` metres forward. A camera without a view gives NaN, which
// packing refuses.
static void combine_axes(const struct job *job, double time, double scale_right, double scale_up, double ahead,
                         double value[static 9])
{
    struct camera_view view;

    if (!camera_view_init(&view, &job->scene.camera, time, job->width_px, job->height_px, NULL)) {
        value[0] = value[1] = value[2] = NAN;
        return;
    }
    for (int i = 0; i < 3; ++i)
        value[i] = scale_right * view.half_width * view.right[i] + scale_up * view.half_height * view.up[i] +
                   ahead * view.forward[i];
}

static void evaluate_camera_corner(const void *source, double time, double value[static 9])
{
    combine_axes(source, time, -1, 1, 1, value);
}

static void evaluate_camera_across(const void *source, double time, double value[static 9])
{
    const struct job *job = source;

    combine_axes(job, time, 2.0 / job->width_px, 0, 0, value);
}

static void evaluate_camera_down(const void *source, double time, double value[static 9])
{
    const struct job *job = source;

    combine_axes(job, time, 0, -2.0 / job->height_px, 0, value);
}

struct range {
    double min, max;
};

static const struct range any = {-FLT_MAX, FLT_MAX};
static const struct range not_negative = {0, FLT_MAX};

__attribute__((format(printf, 3, 4))) static void add(struct frame_uniforms *uniforms, struct frame_value value,
                                                      const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(value.name, sizeof value.name, format, arguments);
    va_end(arguments);
    frame_uniforms_add(uniforms, &value);
}

static struct frame_value of_timeline(const struct timeline *timeline, enum frame_value_type type, struct range range,
                                      const char *meaning)
{
    return (struct frame_value){.type = type,
                                .is_constant = timeline_is_constant(timeline),
                                .evaluate = evaluate_timeline,
                                .source = timeline,
                                .min = range.min,
                                .max = range.max,
                                .meaning = meaning};
}

static void add_camera(struct frame_uniforms *uniforms, const struct job *job)
{
    static const struct {
        const char *name;
        frame_value_evaluate *evaluate;
    } values[] = {{"camera_position", evaluate_camera_position},
                  {"camera_corner", evaluate_camera_corner},
                  {"camera_across", evaluate_camera_across},
                  {"camera_down", evaluate_camera_down}};
    const struct scene_camera *camera = &job->scene.camera;
    bool position_is_fixed = timeline_is_constant(&camera->position);
    bool view_is_fixed = position_is_fixed && timeline_is_constant(&camera->target) &&
                         timeline_is_constant(&camera->up) && timeline_is_constant(&camera->fov);

    for (size_t i = 0; i < sizeof values / sizeof *values; ++i)
        add(uniforms,
            (struct frame_value){.type = FRAME_VALUE_VEC3,
                                 .is_constant = i == 0 ? position_is_fixed : view_is_fixed,
                                 .evaluate = values[i].evaluate,
                                 .source = job,
                                 .min = any.min,
                                 .max = any.max,
                                 .meaning = "camera"},
            "%s", values[i].name);
}

static void add_fold_fractal(struct frame_uniforms *uniforms, const struct scene_fold_fractal *fractal, size_t medium)
{
    static const struct range exponents = {1e-6, 1e6};

    add(uniforms,
        (struct frame_value){.type = FRAME_VALUE_MAT3,
                             .is_constant = timeline_is_constant(&fractal->rotate_x_rad) &&
                                            timeline_is_constant(&fractal->rotate_y_rad),
                             .evaluate = evaluate_rotation,
                             .source = fractal,
                             .min = -1,
                             .max = 1,
                             .meaning = "density.rotate_x_rad and rotate_y_rad"},
        "medium_%zu_rotation", medium);
    add(uniforms, of_timeline(&fractal->offset, FRAME_VALUE_FLOAT, any, "density.offset"), "medium_%zu_offset", medium);
    add(uniforms, of_timeline(&fractal->radius, FRAME_VALUE_FLOAT, any, "density.radius"), "medium_%zu_radius", medium);
    add(uniforms, of_timeline(&fractal->exponent, FRAME_VALUE_FLOAT, exponents, "density.exponent"),
        "medium_%zu_exponent", medium);
    add(uniforms, of_timeline(&fractal->scale, FRAME_VALUE_FLOAT, not_negative, "density.scale"), "medium_%zu_scale",
        medium);
}

static void add_lobes(struct frame_uniforms *uniforms, const struct scene_medium *medium,
                      const struct medium_features *features, size_t index)
{
    const struct range gs = {-largest_g, largest_g};
    static const struct range weights = {0, 1};

    for (size_t i = 0; i < medium->lobe_count; ++i) {
        if (features->lobes[i] == LOBE_UNSEEN) continue;
        if (features->lobes[i] == LOBE_HENYEY_GREENSTEIN)
            add(uniforms, of_timeline(&medium->lobes[i].g, FRAME_VALUE_FLOAT, gs, "phase.g"), "medium_%zu_lobe_%zu_g",
                index, i);
        add(uniforms, of_timeline(&medium->lobes[i].weight, FRAME_VALUE_FLOAT, weights, "phase.weight"),
            "medium_%zu_lobe_%zu_weight", index, i);
    }
}

static void add_medium(struct frame_uniforms *uniforms, const struct scene_medium *medium,
                       const struct medium_features *features, enum frame_value_type spectrum, size_t index)
{
    add_fold_fractal(uniforms, &medium->density.fold_fractal, index);
    if (features->scatters || features->absorbs)
        add(uniforms,
            (struct frame_value){.type = spectrum,
                                 .is_constant =
                                     timeline_is_constant(&medium->sigma_s) && timeline_is_constant(&medium->sigma_a),
                                 .evaluate = evaluate_sigma_t,
                                 .source = medium,
                                 .min = 0,
                                 .max = FLT_MAX,
                                 .meaning = "sigma_s + sigma_a"},
            "medium_%zu_sigma_t", index);
    if (features->emits)
        add(uniforms, of_timeline(&medium->emission, spectrum, not_negative, "emission"), "medium_%zu_emission", index);
}

static void add_light(struct frame_uniforms *uniforms, const struct scene_light *light, enum frame_value_type spectrum,
                      size_t index)
{
    add(uniforms, of_timeline(&light->intensity, spectrum, not_negative, "lights.intensity"), "light_%zu_intensity",
        index);
    if (light->kind == SCENE_LIGHT_SUN) {
        struct frame_value direction = of_timeline(&light->direction, FRAME_VALUE_VEC3, any, "lights.direction");

        direction.evaluate = evaluate_toward_sun;
        add(uniforms, direction, "light_%zu_direction", index);
    } else {
        add(uniforms, of_timeline(&light->position, FRAME_VALUE_VEC3, any, "lights.position"), "light_%zu_position",
            index);
    }
}

static bool ball_is_fixed(const struct scene *scene)
{
    bool is_fixed = true;

    for (size_t i = 0; i < scene->medium_count; ++i)
        is_fixed = is_fixed && timeline_is_constant(&scene->media[i].density.fold_fractal.offset) &&
                   timeline_is_constant(&scene->media[i].density.fold_fractal.radius);
    return is_fixed;
}

void scene_values_add(struct frame_uniforms *uniforms, const struct job *job, const struct scene_features *features)
{
    enum frame_value_type spectrum = features->is_rgb ? FRAME_VALUE_VEC3 : FRAME_VALUE_FLOAT;
    const struct scene *scene = &job->scene;

    if (features->has_media) {
        add_camera(uniforms, job);
        add(uniforms,
            (struct frame_value){.type = FRAME_VALUE_FLOAT,
                                 .is_constant = ball_is_fixed(scene),
                                 .evaluate = evaluate_ball_radius,
                                 .source = scene,
                                 .min = any.min,
                                 .max = any.max,
                                 .meaning = "density.offset and radius"},
            "ball_radius");
    }
    for (size_t i = 0; i < scene->medium_count; ++i) {
        const struct scene_medium *medium = &scene->media[i];

        if (!features->media[i].is_seen) continue;
        add_medium(uniforms, medium, &features->media[i], spectrum, i);
        if (!features->has_lights || !features->media[i].scatters) continue;
        add(uniforms, of_timeline(&medium->sigma_s, spectrum, not_negative, "sigma_s"), "medium_%zu_sigma_s", i);
        add_lobes(uniforms, medium, &features->media[i], i);
    }
    for (size_t i = 0; i < scene->light_count; ++i)
        if (features->light_is_seen[i]) add_light(uniforms, &scene->lights[i], spectrum, i);
    if (features->has_background)
        add(uniforms, of_timeline(&scene->background, spectrum, not_negative, "background"), "background");
}
