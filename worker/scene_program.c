#include "worker/scene_program.h"

#include "core/error.h"
#include "core/job.h"
#include "worker/camera_view.h"
#include "worker/density_kind.h"
#include "worker/gl_program.h"
#include "worker/scene_bounds.h"
#include "worker/scene_glue.h"
#include "worker/scene_glue_gather.h"
#include "worker/scene_glue_media.h"
#include "worker/scene_glue_path.h"
#include "worker/scene_glue_surface.h"
#include "worker/scene_inputs.h"
#include "worker/scene_values.h"
#include "worker/shader_sources.h"
#include "worker/texture_glue.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

struct assembly {
    struct scene_program *program;
    const struct job *job;
    const char *shader_dir;
    FILE *out;   // the fragment shader's text
    char **text; // where `out` keeps it, after a flush
    bool failed; // a module could not be read
    struct error *error;
};

static void add_module(struct assembly *assembly, const char *name)
{
    struct scene_program *program = assembly->program;
    char *text;
    size_t length;

    for (size_t i = 1; i < program->module_count; ++i)
        if (strcmp(program->module_names[i], name) == 0) return;
    if (assembly->failed) return;
    text = shader_sources_load(assembly->shader_dir, name, assembly->error);
    if (!text) {
        assembly->failed = true;
        return;
    }
    assert(program->module_count < SCENE_PROGRAM_MODULE_LIMIT);
    length = strlen(text);
    fprintf(assembly->out, "#line %zu %zu\n%s%s", program->module_count * GL_PROGRAM_LINE_STRIDE + 1,
            program->module_count, text, length > 0 && text[length - 1] == '\n' ? "" : "\n");
    program->module_names[program->module_count++] = name;
    free(text);
}

// What follows is generated: its lines are those of the whole text.
static void begin_generated(struct assembly *assembly)
{
    size_t line = 1;

    fflush(assembly->out);
    for (const char *at = *assembly->text; (at = strchr(at, '\n')); ++at)
        ++line;
    fprintf(assembly->out, "#line %zu 0\n", line + 1);
}

static void add_text(struct assembly *assembly, const struct density_text *text)
{
    struct scene_program *program = assembly->program;

    assert(program->module_count < SCENE_PROGRAM_MODULE_LIMIT);
    begin_generated(assembly);
    fprintf(assembly->out, "%s#line %zu %zu\n%s\n", text->before, program->module_count * GL_PROGRAM_LINE_STRIDE + 1,
            program->module_count, text->text);
    program->module_names[program->module_count++] = text->name;
    begin_generated(assembly);
    fputs(text->after, assembly->out);
}

static void add_density(struct assembly *assembly, size_t i)
{
    const struct density_kind *kind = density_kind_of(&assembly->job->scene.media[i].density);
    struct density_text text = {0};
    const struct scene_medium *source = &assembly->job->scene.media[i];
    const struct density_site site = {
        .job = assembly->job, .medium = i, .source = source, .inputs = assembly->program->inputs};
    const char *bounds = scene_bounds_module(&source->density.bounds);

    for (const char *const *name = kind->modules(&site); *name; ++name)
        add_module(assembly, *name);
    if (kind->load_text && !assembly->failed) {
        assembly->failed = !kind->load_text(&site, &text, assembly->error);
        if (!assembly->failed) add_text(assembly, &text);
        free(text.before);
        free(text.after);
    }
    if (bounds) add_module(assembly, bounds);
}

static void add_camera(struct assembly *assembly)
{
    const struct scene_features *features = &assembly->program->features;

    if (features->marches || features->marches_to_lights || features->has_objects)
        add_module(assembly, "math/march.glsl");
    add_module(assembly, "camera/pinhole.glsl");
    if (features->is_random) add_module(assembly, "math/random.glsl");
    if (features->has_samples) add_module(assembly, "camera/pixel_samples.glsl");
    add_module(assembly, "region/span.glsl");
}

static void add_media(struct assembly *assembly)
{
    const struct scene_features *features = &assembly->program->features;

    for (size_t i = 0; i < features->medium_count; ++i)
        if (features->media[i].is_seen) add_density(assembly, i);
    if (features->has_extinction && assembly->job->quality.method != JOB_METHOD_RIEMANN)
        add_module(assembly, "math/segment.glsl");
    if (features->has_extinction && features->has_depth)
        add_module(assembly, features->extinction_is_rgb ? "pass/depth_rgb.glsl" : "pass/depth_grey.glsl");
    begin_generated(assembly);
    scene_glue_write_media(assembly->out, assembly->job, assembly->program);
}

static void add_phase(struct assembly *assembly, const struct scene_medium *medium,
                      const struct medium_features *features)
{
    static const char *const modules[] = {[LOBE_ISOTROPIC] = "phase/isotropic.glsl",
                                          [LOBE_HENYEY_GREENSTEIN] = "phase/henyey_greenstein.glsl",
                                          [LOBE_RAYLEIGH] = "phase/rayleigh.glsl"};

    if (medium->lobe_count == 0) add_module(assembly, "phase/isotropic.glsl");
    for (size_t i = 0; i < medium->lobe_count; ++i)
        if (features->lobes[i] != LOBE_UNSEEN) add_module(assembly, modules[features->lobes[i]]);
}

static void add_placement(struct assembly *assembly)
{
    const struct scene *scene = &assembly->job->scene;

    add_module(assembly, "placement/share.glsl");
    if (assembly->program->features.extinction_is_rgb) add_module(assembly, "placement/cut.glsl");
    for (size_t i = 0; i < scene->light_count; ++i)
        if (assembly->program->features.light_is_seen[i])
            add_module(assembly, scene_light_is_inverse_square(&scene->lights[i]) ? "placement/angle.glsl"
                                                                                  : "placement/transmittance.glsl");
    begin_generated(assembly);
    scene_glue_write_placed(assembly->out, assembly->job);
}

static void add_lights(struct assembly *assembly)
{
    const struct scene *scene = &assembly->job->scene;
    const struct scene_features *features = &assembly->program->features;

    for (size_t i = 0; i < scene->medium_count; ++i)
        if (features->media[i].scatters) add_phase(assembly, &scene->media[i], &features->media[i]);
    add_module(assembly, "light/sample.glsl");
    for (size_t i = 0; i < scene->light_count; ++i)
        if (features->light_is_seen[i])
            add_module(assembly, scene->lights[i].kind == SCENE_LIGHT_SUN         ? "light/sun.glsl"
                                 : scene->lights[i].falloff == SCENE_FALLOFF_NONE ? "light/point_even.glsl"
                                                                                  : "light/point.glsl");
    if (features->has_extinction)
        add_module(assembly, !features->marches_to_lights                          ? "transmittance/closed.glsl"
                             : assembly->job->quality.method == JOB_METHOD_RIEMANN ? "transmittance/riemann.glsl"
                             : features->is_jittered                               ? "transmittance/jittered.glsl"
                                                                                   : "transmittance/midpoint.glsl");
    begin_generated(assembly);
    scene_glue_write_lights(assembly->out, assembly->job, assembly->program);
    if (features->has_objects) scene_glue_write_shadow(assembly->out, assembly->job, assembly->program);
}

static void add_integrator(struct assembly *assembly)
{
    if (assembly->program->features.places_points) add_placement(assembly);
    if (assembly->program->features.has_roulette) add_module(assembly, "integrator/roulette.glsl");
    begin_generated(assembly);
    scene_glue_write_gather(assembly->out, assembly->job, assembly->program);
    add_module(assembly, assembly->job->quality.method == JOB_METHOD_RIEMANN ? "integrator/riemann.glsl"
                         : assembly->program->features.is_jittered           ? "integrator/jittered.glsl"
                         : assembly->program->features.marches               ? "integrator/midpoint.glsl"
                                                                             : "integrator/stretches.glsl");
}

static void add_shape(struct assembly *assembly, enum scene_shape_kind kind)
{
    static const char *const regions[] = {[SCENE_SHAPE_SPHERE] = "region/sphere.glsl",
                                          [SCENE_SHAPE_BOX] = "region/box.glsl",
                                          [SCENE_SHAPE_PLANE] = "region/plane.glsl"};
    static const char *const normals[] = {
        [SCENE_SHAPE_SPHERE] = "surface/sphere.glsl", [SCENE_SHAPE_BOX] = "surface/box.glsl"};

    add_module(assembly, regions[kind]);
    if (kind != SCENE_SHAPE_PLANE) add_module(assembly, normals[kind]);
}

static void add_optics(struct assembly *assembly, const struct scene_material *material,
                       const struct object_features *object)
{
    static const char *const fresnels[] = {[SCENE_FRESNEL_EXACT] = "surface/fresnel_exact.glsl",
                                           [SCENE_FRESNEL_SCHLICK] = "surface/fresnel_schlick.glsl",
                                           [SCENE_FRESNEL_NONE] = "surface/fresnel_none.glsl"};

    if (object->has_fresnel) {
        add_module(assembly, "surface/snell.glsl");
        add_module(assembly, fresnels[material->fresnel]);
    }
    if (object->is_rough) add_module(assembly, "surface/rough.glsl");
}

static void add_texture(struct assembly *assembly, size_t i)
{
    for (const char *const *name = texture_glue_modules(assembly->job, i); *name; ++name)
        add_module(assembly, *name);
    begin_generated(assembly);
    texture_glue_write(assembly->out, assembly->job, assembly->program->inputs, i);
}

static void add_surfaces(struct assembly *assembly)
{
    const struct scene *scene = &assembly->job->scene;
    const struct scene_features *features = &assembly->program->features;

    for (size_t i = 0; i < scene->shape_count; ++i)
        add_shape(assembly, scene->shapes[i].kind);
    for (size_t i = 0; i < scene->object_count; ++i)
        add_optics(assembly, &scene->objects[i].material, &features->objects[i]);
    add_module(assembly, "surface/crossing.glsl");
    begin_generated(assembly);
    scene_glue_write_surfaces(assembly->out, assembly->job, assembly->program);
    add_module(assembly, "surface/visible.glsl");
    for (size_t i = 0; i < scene->object_count; ++i)
        if (features->surfaces_are_lit && scene->objects[i].material.texture.file) add_texture(assembly, i);
}

static void add_path(struct assembly *assembly)
{
    const struct scene_features *features = &assembly->program->features;

    begin_generated(assembly);
    scene_glue_write_seen(assembly->out, assembly->job, assembly->program);
    add_module(assembly, "path/ray.glsl");
    if (features->has_paths) {
        add_module(assembly, features->has_two_paths ? "path/stack.glsl" : "path/single.glsl");
        add_module(assembly, "path/send.glsl");
    }
    begin_generated(assembly);
    scene_glue_write_path(assembly->out, assembly->job, assembly->program);
    add_module(assembly, "path/follow.glsl");
    if (features->has_paths) add_module(assembly, "path/trace.glsl");
    add_module(assembly, "path/turns.glsl");
}

static bool assemble(struct scene_program *program, const struct job *job, const char *shader_dir, struct error *error)
{
    size_t length = 0;
    struct assembly assembly = {
        .program = program, .job = job, .shader_dir = shader_dir, .text = &program->fragment, .error = error};

    assembly.out = open_memstream(&program->fragment, &length);
    if (!assembly.out) {
        error_set(error, "out of memory");
        return false;
    }
    program->module_names[program->module_count++] = "generated";
    fputs("#version 450 core\n", assembly.out);
    add_module(&assembly, "math/constants.glsl");
    add_module(&assembly, program->features.is_rgb ? "math/spectrum_rgb.glsl" : "math/spectrum_grey.glsl");
    begin_generated(&assembly);
    frame_uniforms_declare(&program->uniforms, assembly.out);
    if (program->features.has_media || program->features.has_objects) add_camera(&assembly);
    if (program->features.has_media) add_media(&assembly);
    if (program->features.has_objects) add_surfaces(&assembly);
    if (program->features.has_lights) add_lights(&assembly);
    if (program->features.has_media) add_integrator(&assembly);
    if (program->features.has_objects) add_path(&assembly);
    begin_generated(&assembly);
    scene_glue_write_main(assembly.out, job, program);
    fclose(assembly.out);
    return !assembly.failed;
}

static void hash_texts(struct scene_program *program)
{
    char hashes[2 + SCENE_CACHE_LIMIT][HASH_TEXT_SIZE];

    hash_bytes(program->vertex, strlen(program->vertex), hashes[0]);
    hash_bytes(program->fragment, strlen(program->fragment), hashes[1]);
    for (size_t i = 0; i < program->cache_count; ++i)
        scene_cache_hash(&program->caches[i], hashes[2 + i]);
    hash_bytes(hashes, (2 + program->cache_count) * sizeof *hashes, program->hash);
}

bool scene_program_init(struct scene_program *program, const struct job *job, const struct scene_inputs *inputs,
                        const char *shader_dir, struct error *error)
{
    const struct job_quality *quality = inputs ? &inputs->quality : &job->quality;
    struct camera_view view;

    for (size_t i = 0; i < job->scene.medium_count; ++i)
        if (!density_kind_of(&job->scene.media[i].density)) {
            char place[64];

            *program = (struct scene_program){0};
            scene_format_medium_place(&job->scene, i, place, sizeof place);
            error_set(error, "%s.density: its kind cannot be rendered yet", place);
            return false;
        }
    *program = (struct scene_program){.features = scene_features_of(job, inputs ? inputs->is_unneeded : NULL),
                                      .inputs = inputs,
                                      .step = quality->step,
                                      .light_step = quality->light_step};
    if (!camera_view_init(&view, &job->scene.camera, job_frame_time(job, frame_range_at(&job->frames, 0)),
                          job->width_px, job->height_px, error))
        return false;
    scene_values_add(&program->uniforms, job, inputs, &program->features);
    program->vertex = shader_sources_load(shader_dir, "fullscreen.vert", error);
    if (!program->vertex || !assemble(program, job, shader_dir, error)) {
        scene_program_finish(program);
        return false;
    }
    hash_texts(program);
    return true;
}

void scene_program_finish(struct scene_program *program)
{
    for (size_t i = 0; i < program->cache_count; ++i)
        scene_cache_finish(&program->caches[i]);
    frame_uniforms_finish(&program->uniforms);
    free(program->vertex);
    free(program->fragment);
    *program = (struct scene_program){0};
}
