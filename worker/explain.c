#include "worker/explain.h"

#include "core/job.h"
#include "core/json_write.h"
#include "worker/density_kind.h"
#include "worker/pixel_samples.h"
#include "worker/scene_inputs.h"
#include "worker/scene_program.h"

#include <stdarg.h>
#include <stdio.h>

// One of the two lists is written at a time.
struct listing {
    struct json_writer *writer;
    const struct job *job;
    const struct scene_program *program;
    bool of_modelled;
};

// Writes the feature if it belongs to this list.
__attribute__((format(printf, 4, 5))) static void say(const struct listing *listing, bool is_modelled,
                                                      const char *feature, const char *why_format, ...)
{
    char why[256];
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

static void list_medium(const struct listing *listing, size_t i)
{
    const struct medium_features *features = &listing->program->features.media[i];
    const struct scene_medium *medium = &listing->job->scene.media[i];
    char name[64];

    snprintf(name, sizeof name, "medium %zu", i);
    say(listing, features->is_seen, name, features->is_seen ? "%s density" : "its %s density is 0, or it does nothing",
        density_kind_of(&medium->density)->name);
    if (!features->is_seen) return;
    snprintf(name, sizeof name, "medium %zu: absorption", i);
    say(listing, features->absorbs, name, "%s", features->absorbs ? "sigma_a is not 0" : "sigma_a is 0");
    snprintf(name, sizeof name, "medium %zu: scattering", i);
    say(listing, features->scatters, name, "%s", features->scatters ? "sigma_s is not 0" : "sigma_s is 0");
    snprintf(name, sizeof name, "medium %zu: emission", i);
    say(listing, features->emits, name, "%s",
        features->emits        ? "emission is not 0"
        : medium->has_emission ? "emission is 0"
                               : "the medium has no emission");
    if (!features->scatters || !listing->program->features.has_lights) return;
    snprintf(name, sizeof name, "medium %zu: phase function", i);
    say(listing, true, name, "%s", medium->lobe_count ? "the medium's lobes" : "isotropic, for it names none");
}

static void list_lights(const struct listing *listing)
{
    const struct scene_features *features = &listing->program->features;
    const struct scene *scene = &listing->job->scene;

    for (size_t i = 0; i < scene->light_count; ++i) {
        char name[64];
        bool is_point = scene->lights[i].kind == SCENE_LIGHT_POINT;

        snprintf(name, sizeof name, "light %zu", i);
        say(listing, features->light_is_seen[i], name, "%s",
            features->light_is_seen[i] ? (is_point ? "a point light that media scatter" : "a sun that media scatter")
                                       : "it does not shine, or no medium scatters");
    }
    say(listing, features->has_lights, "shadows", "%s",
        features->has_lights      ? "media take light away on its way to where it is scattered"
        : scene->light_count == 0 ? "there are no lights"
                                  : "no light is seen");
}

static void list_outputs(const struct listing *listing)
{
    const struct scene_features *features = &listing->program->features;
    const struct scene *scene = &listing->job->scene;

    say(listing, features->has_extinction, "extinction", "%s",
        features->has_extinction ? "a medium scatters or absorbs" : "no medium scatters or absorbs");
    say(listing, features->is_rgb, "colour", "%s",
        features->is_rgb ? "a coefficient, a light or the background differs between red, green and blue"
                         : "everything seen is grey, so one number stands for all three");
    say(listing, features->has_background, "background", "%s",
        features->has_background ? "it is not black"
        : scene->has_background  ? "it is black"
                                 : "the job has none; the picture has alpha instead");
    say(listing, features->has_depth, "depth", "%s",
        features->has_depth ? "output.aovs names Z" : "output.aovs does not name Z");
    say(listing, features->has_transmittance, "transmittance output", "%s",
        features->has_transmittance ? "output.aovs names transmittance" : "output.aovs does not name transmittance");
}

// What changes with the frame, whichever sample.
static bool is_moving(const struct frame_value *value)
{
    return !value->is_constant && value->origin != FRAME_VALUE_SAMPLE_INDEX;
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
    bool has_samples = listing->program->features.has_samples;
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
        say(listing, false, "motion blur", "one sample sees the middle of the time that the shutter is open");
    else
        say(listing, true, "motion blur", "%d moments of the %g frames that the shutter is open", samples, shutter);
}

static void list_method(const struct listing *listing)
{
    const struct job_quality *quality = &listing->job->quality;
    bool has_media = listing->program->features.has_media;

    say(listing, has_media, "marching", has_media ? "%s, step %g m" : "no medium is seen",
        job_method_name(quality->method), listing->program->step);
    if (has_media)
        say(listing, quality->min_transmittance > 0, "early stop",
            quality->min_transmittance > 0 ? "a ray ends below transmittance %g" : "min_transmittance is %g",
            quality->min_transmittance);
    if (listing->program->features.has_roulette)
        say(listing, true, "roulette", "below transmittance %g a ray goes on with probability %g",
            quality->roulette_below, quality->roulette_survive);
    say(listing, false, "multiple scattering", "light is scattered once at most");
    say(listing, false, "surfaces", "the scene has no objects");
    list_samples(listing);
}

static void write_list(struct listing listing, const char *key, bool of_modelled)
{
    listing.of_modelled = of_modelled;
    json_write_key(listing.writer, key);
    json_write_begin_array(listing.writer);
    for (size_t i = 0; i < listing.job->scene.medium_count; ++i)
        list_medium(&listing, i);
    list_lights(&listing);
    list_outputs(&listing);
    list_motion(&listing);
    list_method(&listing);
    json_write_end_array(listing.writer);
}

bool explain_write(const struct job *job, const char *shader_dir, struct json_writer *writer, struct error *error)
{
    struct scene_program program = {0};
    struct scene_inputs inputs = {0};
    struct listing listing = {.writer = writer, .job = job, .program = &program};

    if (!scene_inputs_open(&inputs, job, frame_range_at(&job->frames, 0), NULL, NULL, error)) return false;
    if (!scene_program_init(&program, job, &inputs, shader_dir, error)) {
        scene_inputs_finish(&inputs);
        return false;
    }
    json_write_begin_object(writer);
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
