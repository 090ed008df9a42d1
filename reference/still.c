// SPDX-License-Identifier: Apache-2.0
#include "reference/still.h"

#include "core/job/job.h"
#include "core/scene/light_rules.h"
#include "core/scene/timeline.h"

#include <string.h>

static double number_at(const struct timeline *timeline, double time)
{
    double value[3] = {0.0, 0.0, 0.0};

    timeline_evaluate(timeline, time, value);
    return value[0];
}

// A single number stands for all three channels.
static void color_at(const struct timeline *timeline, double time, double color[static 3])
{
    timeline_evaluate(timeline, time, color);
    if (timeline->component_count == 3) return;
    color[1] = color[0];
    color[2] = color[0];
}

static struct vec3 vector_at(const struct timeline *timeline, double time)
{
    double value[3] = {0.0, 0.0, 0.0};

    timeline_evaluate(timeline, time, value);
    return vec3_from(value);
}

static double fractal_at(const void *field, struct vec3 position)
{
    return density_fold_fractal(field, position);
}

static double fractal_at_image(const void *field, struct vec3 image)
{
    return density_fold_fractal_folded(field, image);
}

static void fractal_spans(const void *field, const struct ray *ray, double near, double far, struct span_list *spans)
{
    density_fold_fractal_spans(field, ray, near, far, spans);
}

static double fractal_most(const void *field, const struct box *box)
{
    return density_fold_fractal_most(field, box);
}

static bool fractal_extent(const void *field, struct box *box)
{
    double bound = density_fold_fractal_bound(field);

    *box = (struct box){.half = {bound, bound, bound}};
    return true;
}

struct density still_fractal_density(const struct density_fold_fractal *fractal)
{
    return (struct density){.field = fractal,
                            .at = fractal_at,
                            .at_image = fractal_at_image,
                            .spans = fractal_spans,
                            .most = fractal_most,
                            .extent = fractal_extent};
}

static void stop_fractal(struct density_fold_fractal *fractal, const struct scene_fold_fractal *source, double time)
{
    density_fold_fractal_init(fractal, &(struct density_fold_fractal_params){
                                           .iterations = source->iterations,
                                           .offset = number_at(&source->offset, time),
                                           .radius = number_at(&source->radius, time),
                                           .exponent = number_at(&source->exponent, time),
                                           .scale = number_at(&source->scale, time),
                                           .rotate_x_rad = number_at(&source->rotate_x_rad, time),
                                           .rotate_y_rad = number_at(&source->rotate_y_rad, time),
                                       });
}

// Noise rotates about the centre of its bounds.
static void stop_noise(struct density_noise *noise, const struct scene_density *source, double time)
{
    const struct scene_noise *numbers = &source->noise;
    struct density_noise_params params = {
        .octaves = numbers->octaves,
        .mode = numbers->mode,
        .frequency = number_at(&numbers->frequency, time),
        .lacunarity = number_at(&numbers->lacunarity, time),
        .hurst = number_at(&numbers->hurst, time),
        .bias = number_at(&numbers->bias, time),
        .offset = vector_at(&numbers->offset, time),
        .axis = vector_at(&numbers->axis, time),
        .angle_deg = number_at(&numbers->angle, time),
        .scale = number_at(&numbers->scale, time),
    };

    if (source->bounds.kind != SCENE_BOUNDS_NONE) params.center = vector_at(&source->bounds.center, time);
    density_noise_init(noise, &params);
}

static struct bounds stop_bounds(const struct scene_bounds *source, double time)
{
    struct bounds bounds = {.kind = source->kind};

    if (source->kind == SCENE_BOUNDS_NONE) return bounds;
    bounds.center = vector_at(&source->center, time);
    bounds.falloff = number_at(&source->falloff, time);
    switch (source->kind) {
    case SCENE_BOUNDS_NONE:
        break;
    case SCENE_BOUNDS_SPHERE:
        bounds.radius = number_at(&source->radius, time);
        break;
    case SCENE_BOUNDS_BOX:
        bounds.half = vec3_scale(vector_at(&source->size, time), 0.5);
        break;
    case SCENE_BOUNDS_SLAB:
        bounds.normal = vec3_normalize(vector_at(&source->normal, time));
        bounds.half_thickness = 0.5 * number_at(&source->thickness, time);
        break;
    }
    return bounds;
}

// Moves the grid's centre.
static void move_middle(double index_to_world[static 12], const int size[static 3], struct vec3 center)
{
    const double wanted[3] = {center.x, center.y, center.z};

    for (int a = 0; a < 3; a++) {
        double *row = &index_to_world[4 * a];

        row[3] = wanted[a] - 0.5 * (row[0] * (size[0] - 1) + row[1] * (size[1] - 1) + row[2] * (size[2] - 1));
    }
}

// Moves the file's origin: the centre of the active voxels' box differs from file to file.
static void move_origin(double index_to_world[static 12], struct vec3 center)
{
    index_to_world[3] += center.x;
    index_to_world[7] += center.y;
    index_to_world[11] += center.z;
}

static struct grid_params stop_placement(const struct scene_grid *source, const struct still_grid *input, double time)
{
    struct grid_params params = {.values = input->values,
                                 .size = {input->size[0], input->size[1], input->size[2]},
                                 .is_nearest = source->is_nearest,
                                 .is_padded = input->is_padded};

    memcpy(params.index_to_world, input->index_to_world, sizeof params.index_to_world);
    if (source->has_center && input->is_padded)
        move_origin(params.index_to_world, vector_at(&source->center, time));
    else if (source->has_center)
        move_middle(params.index_to_world, params.size, vector_at(&source->center, time));
    return params;
}

static void stop_grid(struct density_grid *density, const struct scene_grid *source, const struct still_grid *input,
                      double time)
{
    struct grid_params params = stop_placement(source, input, time);

    *density = (struct density_grid){.has_transfer = source->point_count > 0};
    grid_init(&density->grid, &params);
    if (density->has_transfer) {
        density->transfer = (struct transfer_function){.points = source->points,
                                                       .count = source->point_count,
                                                       .unit_distance = number_at(&source->unit_distance, time)};
    } else {
        density->scale = number_at(&source->scale, time);
    }
}

// False when the medium's density has neither twin nor input.
static bool stop_density(struct density *density, union still_field *field, const struct scene_density *source,
                         double time, const struct still_grid *grid, const struct still_function *function)
{
    switch (source->kind) {
    case SCENE_DENSITY_FOLD_FRACTAL:
        stop_fractal(&field->fold_fractal, &source->fold_fractal, time);
        *density = still_fractal_density(&field->fold_fractal);
        return true;
    case SCENE_DENSITY_HOMOGENEOUS:
        field->homogeneous.scale = number_at(&source->homogeneous.scale, time);
        *density = density_homogeneous(&field->homogeneous);
        return true;
    case SCENE_DENSITY_NOISE:
        stop_noise(&field->noise, source, time);
        *density = density_noise_field(&field->noise);
        return true;
    case SCENE_DENSITY_GRID:
        if (!grid->values) return false;
        stop_grid(&field->grid, &source->grid, grid, time);
        *density = density_grid(&field->grid);
        return true;
    case SCENE_DENSITY_GLSL:
        if (!function->at) return false;
        field->function = (struct density_function){.at = function->at,
                                                    .context = function->context,
                                                    .time = time,
                                                    .scale = number_at(&source->glsl.scale, time),
                                                    .majorant = source->glsl.majorant};
        *density = density_function(&field->function);
        return true;
    }
    return false;
}

static void stop_colors(struct medium *medium, const struct scene_medium *source, double time)
{
    color_at(&source->sigma_s, time, medium->sigma_s);
    color_at(&source->sigma_a, time, medium->sigma_a);
    if (source->has_emission) color_at(&source->emission, time, medium->emission);
    medium->lobe_count = source->lobe_count;
    for (size_t i = 0; i < source->lobe_count; i++) {
        medium->lobes[i].kind = source->lobes[i].kind;
        medium->lobes[i].g = number_at(&source->lobes[i].g, time);
        medium->lobes[i].weight = number_at(&source->lobes[i].weight, time);
    }
}

static void stop_blackbody(struct glow_blackbody *glow, const struct scene_medium *source,
                           const struct still_grid *input, double time)
{
    glow_blackbody_init(glow, &(struct glow_blackbody_params){
                                  .grid = stop_placement(&source->density.grid, input, time),
                                  .kelvin = number_at(&source->blackbody.kelvin, time),
                                  .intensity = number_at(&source->blackbody.intensity, time),
                              });
}

// Appends the scene's medium `index` to the still's media.
static void stop_medium(struct still *still, size_t index, const struct scene_medium *source, double time,
                        const struct still_inputs *inputs)
{
    static const struct density_homogeneous EMPTY;
    size_t slot = still->medium_count++;
    struct medium *medium = &still->media[slot];
    struct density_bounded *bounded = &still->bounded[slot];
    union still_field *field = &still->fields[slot];

    stop_colors(medium, source, time);
    medium->region = source->owner;
    if (!stop_density(&medium->density, field, &source->density, time, &inputs->grids[index],
                      &inputs->functions[index])) {
        medium->density = density_homogeneous(&EMPTY);
        still->is_complete = false;
        return;
    }
    if (source->density.kind == SCENE_DENSITY_GRID && inputs->temperatures[index].values) {
        stop_blackbody(&still->glows[slot], source, &inputs->temperatures[index], time);
        medium->glow = glow_blackbody(&still->glows[slot]);
    }
    if (source->density.kind == SCENE_DENSITY_GRID && field->grid.has_transfer) {
        // The density is the extinction itself.
        for (int c = 0; c < 3; c++)
            medium->sigma_a[c] = 1.0;
        medium->glow = density_grid_glow(&field->grid);
    }
    if (source->density.bounds.kind != SCENE_BOUNDS_NONE) {
        *bounded = (struct density_bounded){medium->density, stop_bounds(&source->density.bounds, time)};
        medium->density = density_bounded(bounded);
    }
}

static void stop_sphere_light(struct sphere_light *lamp, const struct scene_light *source, double time)
{
    lamp->center = vector_at(&source->position, time);
    lamp->radius = number_at(&source->radius, time);
    color_at(&source->intensity, time, lamp->radiance);
    for (int c = 0; c < 3; c++)
        lamp->radiance[c] /= M_PI * lamp->radius * lamp->radius;
}

static void stop_dome(struct still *still, const struct scene_light *source, double time,
                      const struct still_texture *image)
{
    still->dome = (struct dome){.kind = source->dome.kind,
                                .axis = vec3_normalize(vector_at(&source->dome.axis, time)),
                                .angle = number_at(&source->dome.angle, time) * M_PI / 180.0,
                                .rgb = image->rgb,
                                .width = image->rgb ? image->width : 0,
                                .height = image->rgb ? image->height : 0,
                                .is_visible = source->dome.is_visible};
    color_at(&source->intensity, time, still->dome.along);
    color_at(&source->dome.opposite, time, still->dome.against);
    still->has_dome = true;
    if (source->dome.kind == SCENE_DOME_FILE && !image->rgb) still->is_complete = false;
}

static void stop_small_light(struct light *light, const struct scene_light *source, double time)
{
    light->kind = source->kind;
    light->falloff = source->falloff;
    color_at(&source->intensity, time, light->intensity);
    light->position = vector_at(&source->position, time);
    light->inner = number_at(&source->inner, time) * M_PI / 180.0;
    light->outer = number_at(&source->outer, time) * M_PI / 180.0;
    if (light_rules_of(source->kind)->has_direction)
        light->direction = vec3_normalize(vector_at(&source->direction, time));
}

static void stop_lights(struct still *still, const struct scene *scene, double time, const struct still_inputs *inputs)
{
    for (size_t i = 0; i < scene->light_count; i++) {
        const struct scene_light *source = &scene->lights[i];

        switch (source->kind) {
        case SCENE_LIGHT_POINT:
        case SCENE_LIGHT_SUN:
        case SCENE_LIGHT_SPOT:
            stop_small_light(&still->lights[still->light_count++], source, time);
            break;
        case SCENE_LIGHT_SPHERE:
            stop_sphere_light(&still->spheres[still->sphere_count++], source, time);
            break;
        case SCENE_LIGHT_DOME:
            stop_dome(still, source, time, &inputs->dome);
            break;
        }
    }
}

static struct shape stop_shape(const struct scene_shape *source, double time)
{
    struct shape shape = {.kind = source->kind, .center = vector_at(&source->center, time)};

    switch (source->kind) {
    case SCENE_SHAPE_SPHERE:
        shape.radius = number_at(&source->radius, time);
        break;
    case SCENE_SHAPE_BOX:
        shape.half = vec3_scale(vector_at(&source->size, time), 0.5);
        break;
    case SCENE_SHAPE_PLANE:
        shape.normal = vec3_normalize(vector_at(&source->normal, time));
        break;
    }
    return shape;
}

static struct material stop_material(const struct scene_material *source, double time,
                                     const struct still_texture *texture)
{
    struct material material = {
        .kind = source->kind,
        .specular = number_at(&source->specular, time),
        .fresnel = {.kind = source->fresnel,
                    .f0 = number_at(&source->f0, time),
                    .f90 = number_at(&source->f90, time),
                    .has_f0 = source->has_f0},
        .ior = number_at(&source->ior, time),
        .roughness = number_at(&source->roughness, time),
        .texture = {.rgb = texture->rgb,
                    .width = texture->width,
                    .height = texture->height,
                    .is_nearest = source->texture.is_nearest,
                    .size = {source->texture.size[0], source->texture.size[1]}},
    };

    color_at(&source->albedo, time, material.albedo);
    color_at(&source->reflectance, time, material.reflectance);
    return material;
}

static void stop_objects(struct still *still, const struct scene *scene, double time, const struct still_inputs *inputs)
{
    still->objects.count = scene->object_count;
    for (size_t i = 0; i < scene->shape_count; i++)
        still->objects.shapes[i] = stop_shape(&scene->shapes[i], time);
    for (size_t i = 0; i < scene->object_count; i++) {
        const struct scene_object *source = &scene->objects[i];

        if (source->material.texture.file && !inputs->textures[i].rgb) still->is_complete = false;
        still->objects.list[i] =
            (struct object){.first_shape = source->first_shape,
                            .shape_count = source->shape_count,
                            .material = stop_material(&source->material, time, &inputs->textures[i])};
    }
}

struct still_media still_media(const struct still *still, size_t region)
{
    struct still_media media = {.list = still->media};

    for (size_t i = 0; i < still->medium_count; i++) {
        if (still->media[i].region != region) continue;
        if (media.count == 0) media.list = &still->media[i];
        media.count++;
    }
    return media;
}

void still_init(struct still *still, const struct job *job, double time)
{
    static const struct still_inputs NOTHING;

    still_init_with_inputs(still, job, time, &NOTHING);
}

void still_init_with_inputs(struct still *still, const struct job *job, double time, const struct still_inputs *inputs)
{
    const struct scene *scene = &job->scene;

    *still = (struct still){.max_depth = job->quality.max_depth,
                            .min_throughput = job->quality.min_throughput,
                            .has_background = scene->has_background,
                            .is_complete = true};
    camera_pinhole_init(&still->camera, &(struct camera_pinhole_params){
                                            .position = vector_at(&scene->camera.position, time),
                                            .target = vector_at(&scene->camera.target, time),
                                            .up = vector_at(&scene->camera.up, time),
                                            .fov_deg = number_at(&scene->camera.fov, time),
                                            .width_px = job->width_px,
                                            .height_px = job->height_px,
                                            .mirror = scene->camera.mirror,
                                            .clip_near = scene->camera.clip_near,
                                            .clip_far = scene->camera.clip_far,
                                        });
    stop_lights(still, scene, time, inputs);
    for (size_t region = 0; region <= scene->object_count; region++) {
        for (size_t i = 0; i < scene->medium_count; i++)
            if (scene->media[i].owner == region) stop_medium(still, i, &scene->media[i], time, inputs);
    }
    stop_objects(still, scene, time, inputs);
    if (scene->has_background) color_at(&scene->background, time, still->background);
}
