// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/explain.h"

#include "core/job/job.h"
#include "core/job/job_beyond.h"
#include "core/job/job_pixels.h"
#include "core/json/json_write.h"
#include "core/scene/light_rules.h"
#include "worker/answer/explain_count.h"
#include "worker/answer/explain_scattering.h"
#include "worker/density/density_bake.h"
#include "worker/density/density_kind.h"
#include "worker/model/light_grid.h"
#include "worker/scene/pixel_samples.h"
#include "worker/scene/scene_inputs.h"
#include "worker/shader/scene_program.h"

#include <stdarg.h>
#include <stdio.h>

// Writes one of the two lists, modelled and not modelled, at a time.
struct listing {
    struct json_writer *writer;
    const struct job *job;
    const struct scene_program *program;
    const struct scene_inputs *inputs; // of the first frame
    const struct job_beyond *beyond;
    bool of_modelled;
};

// Writes the feature if it belongs to the list that is being written.
__attribute__((format(printf, 4, 5))) static void say(const struct listing *listing, bool is_modelled,
                                                      const char *feature, const char *why_format, ...)
{
    char why[EXPLAIN_SCATTERING_SIZE];
    va_list arguments;

    if (is_modelled != listing->of_modelled) return;
    va_start(arguments, why_format);
    vsnprintf(why, sizeof why, why_format, arguments);
    va_end(arguments);
    json_write_begin_object(listing->writer);
    json_write_string_member(listing->writer, "feature", feature);
    json_write_string_member(listing->writer, "why", why);
    json_write_end_object(listing->writer);
}

// Writes the feature of medium i, as "medium I: FEATURE".
static void say_of_medium(const struct listing *listing, size_t i, bool is_modelled, const char *feature,
                          const char *why)
{
    char name[64];

    snprintf(name, sizeof name, "medium %zu: %s", i, feature);
    say(listing, is_modelled, name, "%s", why);
}

static void list_region(const struct listing *listing, size_t i)
{
    static const char *const regions[] = {"the job gives none", "a sphere", "a box", "a slab"};
    const struct medium_features *features = &listing->program->model.features.media[i];
    enum scene_bounds_kind bounds = listing->job->scene.media[i].density.bounds.kind;

    say_of_medium(listing, i, bounds != SCENE_BOUNDS_NONE, "bounds", regions[bounds]);
    say_of_medium(listing, i, features->has_falloff, "falloff",
                  features->has_falloff         ? "density rises smoothly from the bounds inwards"
                  : bounds == SCENE_BOUNDS_NONE ? "there are no bounds"
                                                : "falloff is 0");
    say_of_medium(listing, i, features->is_even, "closed form",
                  features->is_even ? "density is the same throughout: columns are lengths, and need no steps"
                                    : "density varies with position");
}

// The box of the voxels: only the file says where it is, and a camera that misses it shows nothing.
static void list_voxels(const struct listing *listing, size_t i)
{
    const struct scene_input *input = &listing->inputs->media[i];
    const int *size = input->header.size;
    double low[3], high[3];
    char why[200];

    if (!input->source) return;
    scene_input_box(input, job_frame_time(listing->job, frame_range_at(&listing->job->frames, 0)), low, high);
    snprintf(why, sizeof why, "%d x %d x %d, from (%g, %g, %g) to (%g, %g, %g) m", size[0], size[1], size[2], low[0],
             low[1], low[2], high[0], high[1], high[2]);
    say_of_medium(listing, i, true, "voxels", why);
}

static void list_phase(const struct listing *listing, size_t i)
{
    static const char *const names[] = {
        [LOBE_ISOTROPIC] = "isotropic", [LOBE_HENYEY_GREENSTEIN] = "Henyey-Greenstein", [LOBE_RAYLEIGH] = "Rayleigh"};
    const struct medium_features *features = &listing->program->model.features.media[i];
    const struct scene_medium *medium = &listing->job->scene.media[i];
    char lobes[32 * SCENE_LOBE_LIMIT] = "";
    size_t length = 0;

    for (size_t k = 0; k < medium->lobe_count; ++k)
        if (features->lobes[k] != LOBE_UNSEEN)
            length += (size_t)snprintf(lobes + length, sizeof lobes - length, "%s%s", length ? " + " : "",
                                       names[features->lobes[k]]);
    say_of_medium(listing, i, true, "phase function", medium->lobe_count ? lobes : "isotropic, for it names none");
}

static void list_coefficients(const struct listing *listing, size_t i)
{
    const struct medium_features *features = &listing->program->model.features.media[i];
    const struct scene_medium *medium = &listing->job->scene.media[i];

    say_of_medium(listing, i, features->has_color, "transfer function",
                  features->has_color ? "its points give extinction and source" : "the density has none");
    say_of_medium(listing, i, features->absorbs, "absorption",
                  features->has_color ? "the transfer function's extinction"
                  : features->absorbs ? "sigma_a is not 0"
                                      : "sigma_a is 0");
    say_of_medium(listing, i, features->scatters, "scattering",
                  features->scatters    ? "sigma_s is not 0"
                  : features->has_color ? "a transfer function's light is its own"
                                        : "sigma_s is 0");
    say_of_medium(listing, i, features->emits, "emission",
                  features->emits        ? "emission is not 0"
                  : medium->has_emission ? "emission is 0"
                                         : "the medium has no emission");
    say_of_medium(listing, i, features->glows, "blackbody",
                  features->glows               ? "its temperature makes it glow"
                  : medium->blackbody.grid_name ? "its intensity is 0"
                                                : "the medium has no temperature");
}

// The object that the medium fills, if it fills one.
static void list_owner(const struct listing *listing, size_t i)
{
    size_t owner = listing->job->scene.media[i].owner;
    char why[64];

    if (owner == 0) return;
    snprintf(why, sizeof why, "it fills object %zu and nothing else", owner - 1);
    say_of_medium(listing, i, true, "interior", why);
}

static void list_grid(const struct listing *listing, size_t i)
{
    struct density_bake bake;
    char why[128];

    if (!density_bake_find(&bake, listing->job, i)) return;
    snprintf(why, sizeof why, "its field is interpolated between %d x %d x %d points, %.3g m apart", bake.corners[0],
             bake.corners[1], bake.corners[2], bake.cell_m);
    say_of_medium(listing, i, true, "baked", why);
}

static void list_medium(const struct listing *listing, size_t i)
{
    const struct scene_features *features = &listing->program->model.features;
    bool is_seen = features->media[i].is_seen;
    const struct scene_density *density = &listing->job->scene.media[i].density;
    char name[64];

    snprintf(name, sizeof name, "medium %zu", i);
    if (is_seen && density->kind == SCENE_DENSITY_GLSL)
        say(listing, true, name, "%s density of %s", density_kind_of(density)->name, scene_glsl_name(&density->glsl));
    else
        say(listing, is_seen, name, is_seen ? "%s density" : "its %s density is 0, or it does nothing",
            density_kind_of(density)->name);
    if (!is_seen) return;
    list_owner(listing, i);
    list_voxels(listing, i);
    list_grid(listing, i);
    list_region(listing, i);
    list_coefficients(listing, i);
    if (features->media[i].scatters && features->has_lights) list_phase(listing, i);
}

static void list_media(const struct listing *listing)
{
    const struct scene *scene = &listing->job->scene;

    if (scene->has_vacuum)
        say(listing, true, "vacuum", "random paths fly between objects, and there is no medium");
    else
        for (size_t i = 0; i < scene->medium_count; ++i)
            list_medium(listing, i);
}

static void list_dome_image(const struct listing *listing, size_t i)
{
    const struct texture_input *input = &listing->inputs->dome;
    char name[64];

    if (!listing->job->scene.lights[i].dome.image.file) return;
    snprintf(name, sizeof name, "light %zu: image", i);
    say(listing, true, name, "%d x %d pixels around the scene, filtered linearly", input->width_px, input->height_px);
}

static void list_lights(const struct listing *listing)
{
    const struct scene_features *features = &listing->program->model.features;
    const struct scene *scene = &listing->job->scene;

    for (size_t i = 0; i < scene->light_count; ++i) {
        char name[64];

        snprintf(name, sizeof name, "light %zu", i);
        say(listing, features->light_is_seen[i], name, "%s %s", light_rules_of(scene->lights[i].kind)->noun,
            !features->light_is_seen[i]  ? "that does not shine, or nothing scatters it"
            : !features->media_are_lit   ? "that surfaces show"
            : features->surfaces_are_lit ? "that media scatter and surfaces show"
                                         : "that media scatter");
        list_dome_image(listing, i);
    }
    say(listing, features->has_lights, "shadows", "%s",
        features->has_lights && !features->has_objects
            ? "media attenuate light between its source and where it is scattered"
        : features->has_lights ? "media attenuate light, and objects block it, between its source and where it is seen"
        : scene->light_count == 0 ? "there are no lights"
                                  : "no light is seen");
}

static void list_texture(const struct listing *listing, size_t i)
{
    const struct texture_input *input = &listing->inputs->textures[i];
    char name[64], tiles[64] = "";
    double size[2];

    if (!input->source) return;
    texture_input_find_tile(input, size);
    if (size[0] > 0) snprintf(tiles, sizeof tiles, ", in tiles of %g x %g m", size[0], size[1]); // none around spheres
    snprintf(name, sizeof name, "object %zu: texture", i);
    say(listing, true, name, "%d x %d pixels, %s, %s%s", input->width_px, input->height_px,
        input->source->is_linear ? "taken as linear light" : "decoded from sRGB",
        input->source->is_nearest ? "unfiltered" : "filtered linearly", tiles);
}

static void list_object(const struct listing *listing, size_t i)
{
    static const char *const fresnels[] = {"exact", "Schlick's", "no"};
    const struct object_features *object = &listing->program->model.features.objects[i];
    const struct scene_object *source = &listing->job->scene.objects[i];
    char name[64], reflected[96] = "";

    if (object->has_fresnel)
        snprintf(reflected, sizeof reflected, ", %s Fresnel share reflected", fresnels[source->material.fresnel]);
    snprintf(name, sizeof name, "object %zu", i);
    say(listing, true, name, "%zu shape%s, %s%s%s", source->shape_count, source->shape_count == 1 ? "" : "s",
        !object->is_opaque  ? "dielectric: rays are refracted"
        : object->is_lit    ? "diffuse"
        : !object->reflects ? "black"
                            : "a mirror",
        reflected, object->is_rough ? ", each by a random normal" : "");
    list_texture(listing, i);
}

static void list_surfaces(const struct listing *listing)
{
    const struct scene_features *features = &listing->program->model.features;
    const struct job_quality *quality = &listing->job->quality;
    bool is_vertex = listing->job->scene.orders > 1;

    if (!features->has_objects) {
        say(listing, false, "surfaces", "the scene has no objects");
        return;
    }
    for (size_t i = 0; i < features->object_count; ++i)
        list_object(listing, i);
    say(listing, true, "surfaces", "each ray is intersected with %zu shape%s", listing->job->scene.shape_count,
        listing->job->scene.shape_count == 1 ? "" : "s");
    if (features->has_paths)
        say(listing, true, "paths",
            "up to %d reflections and refractions, while throughput is at least %g; %s; what is cut is counted",
            quality->max_depth, quality->min_throughput,
            features->has_two_paths ? "a dielectric sends two rays on" : "no surface sends two rays on");
    else
        say(listing, false, "paths", "nothing reflects or refracts as a mirror does: camera rays end at surfaces");
    say(listing, is_vertex, "light between surfaces", "%s",
        is_vertex ? "random paths go on from diffuse ones" : "diffuse ones show the light of lights only");
    if (features->has_dielectrics && features->has_lights)
        say(listing, false, "caustics",
            "shadow rays cross dielectrics in straight lines: each boundary takes its Fresnel share, media theirs");
}

static void list_outputs(const struct listing *listing)
{
    const struct scene_features *features = &listing->program->model.features;
    const struct scene *scene = &listing->job->scene;

    say(listing, features->has_extinction, "extinction", "%s",
        features->has_extinction ? "a medium scatters or absorbs" : "no medium scatters or absorbs");
    say(listing, features->is_rgb, "colour", "%s",
        features->is_rgb ? "a coefficient, a light or the background differs between red, green and blue"
                         : "everything seen is grey, so one number stands for all three");
    say(listing, features->has_background, "background", "%s",
        features->dome_is_behind   ? "it is a dome"
        : features->has_background ? "it is not black"
        : scene->has_background    ? "it is black"
                                   : "the job has none; the picture has alpha instead");
    say(listing, features->has_depth, "depth", "%s",
        features->has_depth ? "output.aovs names Z" : "output.aovs does not name Z");
    say(listing, features->has_transmittance, "transmittance output", "%s",
        features->has_transmittance ? "output.aovs names transmittance" : "output.aovs does not name transmittance");
}

// True for values that change from frame to frame.
static bool is_moving(const struct frame_value *value)
{
    return !value->is_constant && value->origin != FRAME_VALUE_SAMPLE_INDEX && value->origin != FRAME_VALUE_STREAM &&
           value->origin != FRAME_VALUE_OF_PLAN && value->origin != FRAME_VALUE_GIVEN;
}

static bool has_motion(const struct frame_uniforms *uniforms)
{
    for (size_t i = 0; i < uniforms->count; ++i)
        if (is_moving(&uniforms->values[i])) return true;
    return false;
}

static void list_motion(const struct listing *listing)
{
    const struct frame_uniforms *uniforms = &listing->program->uniforms;

    for (size_t i = 0; i < uniforms->count; ++i)
        if (is_moving(&uniforms->values[i])) {
            char name[64];

            snprintf(name, sizeof name, "motion of %s", uniforms->values[i].name);
            say(listing, true, name, "it follows %s", uniforms->values[i].meaning);
        }
    say(listing, has_motion(uniforms), "frames that differ", "%s",
        has_motion(uniforms) ? "something seen moves"
                             : "nothing seen moves: the first frame is rendered, the others are copies");
}

static void list_samples(const struct listing *listing)
{
    bool has_samples = listing->program->model.features.has_samples;
    double shutter = listing->job->scene.camera.shutter;
    int samples = pixel_samples_count(listing->job);

    if (has_samples)
        say(listing, true, "antialiasing", "%d rays a pixel, each through a stratum of its own", samples);
    else
        say(listing, false, "antialiasing", "one ray a pixel, through its centre");
    if (shutter == 0)
        say(listing, false, "motion blur", "the camera's shutter is 0");
    else if (!has_motion(&listing->program->uniforms))
        say(listing, false, "motion blur", "nothing seen moves while the shutter is open");
    else if (samples == 1)
        say(listing, false, "motion blur",
            "the one sample is taken in the middle of the time that the shutter is open");
    else
        say(listing, true, "motion blur", "%d moments of the %g frames that the shutter is open", samples, shutter);
}

static void list_pixels(const struct listing *listing)
{
    const struct job_pixels *pixels = &listing->job->quality.pixels;
    const char *obstacle = job_pixels_obstacle(&listing->job->scene, listing->job->quality.method);

    if (pixels->stride > 0)
        say(listing, true, "pixels", "every %d%s, refined where doubt exceeds %g", pixels->stride,
            pixels->stride % 10 == 2 ? "nd" : "th", pixels->threshold);
    else if (obstacle)
        say(listing, false, "pixels", "every pixel is traced: %s has random numbers of its own in each pixel",
            obstacle);
    else
        say(listing, false, "pixels", "every pixel is traced: quality has no pixels");
}

static void list_light_grids(const struct listing *listing)
{
    for (size_t i = 0; i < listing->program->light_grid_count; ++i) {
        const struct light_grid *grid = &listing->program->light_grids[i];
        char name[64];

        snprintf(name, sizeof name, "light %zu: grid", grid->light);
        say(listing, true, name, "%d cells a side, %s; a column of %zu medi%s at each node", grid->cells,
            grid->kind == LIGHT_GRID_BEAM ? "along its beam" : "all around the light", grid->medium_count,
            grid->medium_count == 1 ? "um" : "a");
    }
    say(listing, false, "marching to lights",
        "columns are interpolated in the grids of lights, each filled once a frame");
}

static void list_scattering(const struct listing *listing)
{
    char why[EXPLAIN_SCATTERING_SIZE];
    bool is_modelled = explain_scattering(listing->job, listing->beyond, why);

    say(listing, is_modelled, "multiple scattering", "%s", why);
}

static void list_walk(const struct listing *listing)
{
    const struct scene_features *features = &listing->program->model.features;

    say(listing, true, "random paths", "%d a pixel, by free flights among upper bounds of the densities",
        listing->job->quality.paths);
    say(listing, false, "marching", "random paths take no steps");
    if (features->has_light_grids)
        say(listing, scene_features_count_marched(features) < scene_features_count_lights(features),
            "tracking to lights", "lights that have a place or one direction have grids");
    else if (features->has_lights)
        say(listing, features->tracks_to_lights, "tracking to lights", "%s",
            features->tracks_to_lights ? "transmittances are random estimates" : "columns have a closed form");
}

static void list_method(const struct listing *listing)
{
    const struct job_quality *quality = &listing->job->quality;
    const struct scene_features *features = &listing->program->model.features;
    bool has_media = features->has_media;

    if (features->is_walked)
        list_walk(listing);
    else if (features->marches)
        say(listing, true, "marching", "%s, step %g m", job_method_name(quality->method),
            scene_model_quality(&listing->program->model)->step);
    else
        say(listing, false, "marching", "%s",
            has_media ? "density changes at faces only: each stretch between them is one segment"
                      : "no medium is seen");
    if (features->has_light_grids)
        list_light_grids(listing);
    else if (features->has_lights && !features->is_walked)
        say(listing, features->marches_to_lights, "marching to lights", "%s",
            features->marches_to_lights ? "density varies with position" : "columns have a closed form");
    if (features->places_points)
        say(listing, true, "placed points",
            "%d for each light and stretch, by the angle seen from it or by transmittance", quality->points);
    if (has_media)
        say(listing, quality->min_transmittance > 0, "early stop",
            quality->min_transmittance > 0 ? "a ray ends below transmittance %g" : "min_transmittance is %g",
            quality->min_transmittance);
    if (features->has_roulette)
        say(listing, true, "roulette", "below transmittance %g a ray goes on with probability %g",
            quality->roulette_below, quality->roulette_survive);
    list_scattering(listing);
    list_surfaces(listing);
    list_pixels(listing);
    list_samples(listing);
}

static void write_list(struct listing listing, const char *key, bool of_modelled)
{
    listing.of_modelled = of_modelled;
    json_write_key(listing.writer, key);
    json_write_begin_array(listing.writer);
    list_media(&listing);
    list_lights(&listing);
    list_outputs(&listing);
    list_motion(&listing);
    list_method(&listing);
    json_write_end_array(listing.writer);
}

bool explain_write(const struct explain_params *params, struct json_writer *writer, struct error *error)
{
    const struct job *job = params->job;
    const struct json_writer *plan = params->plan;
    struct scene_program program = {0};
    struct scene_inputs inputs = {0};
    struct listing listing = {
        .writer = writer, .job = job, .program = &program, .inputs = &inputs, .beyond = params->beyond};

    if (!scene_inputs_open(&inputs, job, frame_range_at(&job->frames, 0), NULL, NULL, error)) return false;
    if (!scene_program_init(&program, job, &inputs, params->shader_dir, error)) {
        scene_inputs_finish(&inputs);
        return false;
    }
    json_write_begin_object(writer);
    if (plan) {
        json_write_key(writer, "plan");
        json_write_raw(writer, plan->text, plan->length);
    }
    explain_count_write(job, writer);
    job_beyond_write(params->beyond, writer);
    write_list(listing, "modelled", true);
    write_list(listing, "not_modelled", false);
    json_write_key(writer, "modules");
    json_write_begin_array(writer);
    json_write_string(writer, "fullscreen.vert");
    for (size_t i = 1; i < program.module_count; ++i)
        json_write_string(writer, program.module_names[i]);
    json_write_end_array(writer);
    json_write_string_member(writer, "shader", program.fragment);
    json_write_string_member(writer, "shader_hash", program.hash);
    json_write_integer_member(writer, "uniform_bytes", (int64_t)program.uniforms.size_bytes);
    json_write_end_object(writer);
    scene_program_finish(&program);
    scene_inputs_finish(&inputs);
    return true;
}
