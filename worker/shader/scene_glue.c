// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue.h"

#include "core/job/job.h"
#include "worker/glsl/pixel_mark.h"
#include "worker/model/light_kind.h"
#include "worker/model/scene_model.h"
#include "worker/scene/pixel_samples.h"
#include "worker/shader/scene_glue_gather.h"
#include "worker/shader/scene_glue_light.h"
#include "worker/shader/scene_glue_path.h"
#include "worker/shader/scene_glue_walk_picture.h"

#include <math.h>

static void write_phase(FILE *out, const struct scene_medium *medium, const struct medium_features *features, size_t i)
{
    const char *separator = "";

    fprintf(out, "float medium_%zu_phase(vec3 incoming, vec3 outgoing)\n{\n    return ", i);
    if (medium->lobe_count == 0) fputs("phase_isotropic()", out);
    for (size_t k = 0; k < medium->lobe_count; ++k) {
        if (features->lobes[k] == LOBE_UNSEEN) continue;
        fprintf(out, "%smedium_%zu_lobe_%zu_weight * ", separator, i, k);
        separator = " + ";
        if (features->lobes[k] == LOBE_ISOTROPIC)
            fputs("phase_isotropic()", out);
        else if (features->lobes[k] == LOBE_RAYLEIGH)
            fputs("phase_rayleigh(dot(incoming, outgoing))", out);
        else
            fprintf(out, "phase_henyey_greenstein(PhaseHenyeyGreenstein(medium_%zu_lobe_%zu_g), incoming, outgoing)", i,
                    k);
    }
    fputs(";\n}\n", out);
}

void scene_glue_write_step_limit(FILE *out, const struct scene_model *model)
{
    const struct scene *scene = &model->job->scene;

    if (!model->features.has_peaks) {
        fputs("float march_step_limit(vec3 point, float step)\n{\n    return step;\n}\n", out);
        return;
    }
    fputs("float march_step_limit(vec3 point, float step)\n{\n    float away = FAR_AWAY;\n", out);
    for (size_t i = 0; i < scene->light_count; ++i)
        if (model->features.light_is_seen[i] && light_kind_of(&scene->lights[i])->is_inverse_square)
            fprintf(out, "    away = min(away, distance(point, light_%zu_position));\n", i);
    fputs("    return clamp(LIGHT_POINT_SHARE * away, step / 1024.0, step);\n}\n", out);
}

void scene_glue_write_lights(FILE *out, const struct scene_model *model)
{
    const struct scene *scene = &model->job->scene;

    for (size_t i = 0; i < scene->medium_count; ++i)
        if (model->features.media[i].scatters) write_phase(out, &scene->media[i], &model->features.media[i], i);
    for (size_t i = 0; i < scene->light_count; ++i)
        if (model->features.light_is_seen[i]) scene_glue_light_write_functions(out, &scene->lights[i], i);
}

static void write_interval(FILE *out, const struct scene_camera *camera)
{
    fputs("    vec2 interval = media_interval(spans);\n", out);
    fprintf(out, "    interval.x = max(interval.x, %.9e);\n", camera->clip_near);
    if (isfinite(camera->clip_far)) fprintf(out, "    interval.y = min(interval.y, %.9e);\n", camera->clip_far);
}

// Writes the image point that this pass samples, and the start of its random numbers.
static void write_point(FILE *out, const struct scene_model *model)
{
    fputs("    uvec2 pixel = pixel_drawn();\n", out);
    if (model->features.has_samples)
        fputs("    vec2 point_px = pixel_samples_point(PixelSamples(uint(sample_columns), uint(sample_rows)), pixel,\n"
              "                                        uint(sample_index), uint(frame_seed));\n",
              out);
    else if (model->features.is_random)
        fputs("    random_start(pixel, uint(sample_index), uint(frame_seed));\n", out);
}

static void write_view(FILE *out, const struct scene_model *model)
{
    write_point(out, model);
    fputs("    CameraPinhole camera = CameraPinhole(camera_position, camera_corner, camera_across, camera_down);\n"
          "    vec3 toward = camera_pinhole_toward(camera, ",
          out);
    fprintf(out, "%s);\n    vec3 direction = normalize(toward);\n",
            model->features.has_samples ? "point_px" : "vec2(pixel) + 0.5");
}

// Samples of a Riemann sum do not depend on the media's spans.
static void write_march(FILE *out, const struct scene_model *model)
{
    bool has_interval = model->job->quality.method != JOB_METHOD_RIEMANN;

    fputs("    MediaSpans spans = media_spans(camera.position, direction);\n", out);
    fputs("    pixel_sign(media_met(spans));\n", out);
    if (has_interval) write_interval(out, &model->job->scene.camera);
    scene_glue_write_integrator(out, model,
                                has_interval ? "camera.position, direction, interval" : "camera.position, direction");
}

// The depth of several passes comes with a count, so that the mean leaves out passes without a depth.
static void write_outputs(FILE *out, const struct scene_model *model)
{
    fputs("layout(location = 0) out vec4 rgba;\n", out);
    if (model->features.has_transmittance) fputs("layout(location = 1) out vec4 transmittance;\n", out);
    if (model->features.has_depth)
        fprintf(out, "layout(location = 2) out %s depth;\n", pixel_samples_count(model->job) > 1 ? "vec2" : "float");
    if (model->features.has_paths) fputs("layout(location = 3) out vec4 paths;\n", out);
    fputs("layout(location = 4) out uint signature;\n", out);
}

static void write_background(FILE *out, const struct scene_model *model)
{
    fprintf(out, "    rgba = vec4(spectrum_rgb(%s", model->features.has_media ? "gathered.radiance + " : "");
    if (model->features.has_extinction) fputs("gathered.transmittance * ", out);
    scene_glue_light_write_behind(out, model, "direction");
    fputs("), 1.0);\n", out);
}

static void write_depth(FILE *out, const struct job *job, const char *depth)
{
    if (pixel_samples_count(job) > 1)
        fprintf(out, "    depth.x = %s;\n    depth.y = depth.x > 0.0 ? 1.0 : 0.0;\n", depth);
    else
        fprintf(out, "    depth = %s;\n", depth);
}

// A majorant that the job states may be too low.
static bool majorant_mark_is_needed(const struct scene_model *model)
{
    bool is_stated = false;

    for (size_t i = 0; i < model->features.medium_count; ++i)
        is_stated |= model->features.media[i].is_seen &&
                     density_kind_of(&model->job->scene.media[i].density)->has_stated_majorant;
    return is_stated && model->features.has_majorants;
}

static void write_majorant_mark(FILE *out, const struct scene_model *model)
{
    if (majorant_mark_is_needed(model))
        fprintf(out, "    if (majorant_low >= 0) rgba.a = %.9e * pow(%.1f, float(majorant_low));\n",
                (double)PIXEL_MARK_MAJORANT, (double)PIXEL_MARK_FACTOR);
}

static void write_media_picture(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    if (features->has_background)
        write_background(out, model);
    else if (features->has_media)
        fprintf(out, "    rgba = vec4(spectrum_rgb(gathered.radiance), %s);\n",
                scene_has_behind(&model->job->scene) ? "1.0"
                : features->has_extinction           ? "1.0 - spectrum_mean(gathered.transmittance)"
                                                     : "0.0");
    else
        fprintf(out, "    rgba = vec4(0.0, 0.0, 0.0, %s);\n", scene_has_behind(&model->job->scene) ? "1.0" : "0.0");
    if (features->has_transmittance)
        fprintf(out, "    transmittance = vec4(%s, 0.0);\n",
                features->has_extinction ? "spectrum_rgb(gathered.transmittance)" : "vec3(1.0)");
    if (features->has_depth)
        write_depth(out, model->job, features->has_extinction ? "gathered.depth / length(toward)" : "0.0");
    if (features->is_sliced)
        fputs("    if (is_paused) rgba.a = -1e6; // it comes no further\n", out);
    else if (features->marches)
        fputs("    if (march_was_cut) rgba.a = -1e6; // no picture has it, nor has a sum of them\n", out);
    write_majorant_mark(out, model);
}

static void write_media(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    bool finds_depth = features->has_depth && features->has_extinction;

    fprintf(out, "    Gathered gathered = Gathered(spectrum(0.0)%s%s);\n",
            features->has_extinction ? ", spectrum(1.0)" : "", finds_depth ? ", 0.0" : "");
    write_view(out, model);
    if (features->is_sliced && features->is_random)
        fputs("    if (slice_is_begun) random_state = slice_random;\n", out);
    write_march(out, model);
    if (features->has_extinction) fputs("    pixel_is_dimmed = spectrum_mean(gathered.transmittance) < 1.0;\n", out);
}

static void write_media_main(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    if (features->is_walked) {
        write_view(out, model);
        scene_glue_write_walk_picture(out, model);
        write_majorant_mark(out, model);
        return;
    }
    if (features->is_sliced) fputs("    bool is_done = false;\n    if (slice_load()) {\n", out);
    if (features->has_media)
        write_media(out, model);
    else if (features->has_rays)
        write_view(out, model);
    if (features->is_sliced)
        fprintf(out, "    bool is_paused = !slice_is_over%s;\n    is_done = slice_store(is_paused);\n",
                majorant_mark_is_needed(model) ? " && majorant_low < 0" : "");
    write_media_picture(out, model);
    if (features->is_sliced) fputs("    }\n    if (!is_done) discard;\n", out);
}

static void write_path_main(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    write_view(out, model);
    scene_glue_write_path_start(out, model);
    fprintf(out, "    rgba = vec4(spectrum_rgb(path_radiance), %s);\n",
            scene_has_behind(&model->job->scene) ? "1.0" : "1.0 - spectrum_mean(path_behind)");
    if (features->has_transmittance) fputs("    transmittance = vec4(spectrum_rgb(path_behind), 0.0);\n", out);
    if (features->has_depth) write_depth(out, model->job, "path_depth / length(toward)");
    if (features->has_paths) fputs("    paths = path_counts;\n", out);
    fputs("    if (march_was_cut || path_iterations_are_spent())\n"
          "        rgba.a = -1e6; // no picture has it, nor has a sum of them\n",
          out);
}

void scene_glue_write_main(FILE *out, const struct scene_model *model, bool has_frame_values)
{
    write_outputs(out, model);
    if (model->features.is_walked) scene_glue_write_walk_slice(out, model);
    fputs("void main()\n{\n", out);
    if (has_frame_values) fputs("    frame_uniforms_read();\n", out);
    if (model->features.has_objects && !model->features.is_walked)
        write_path_main(out, model);
    else
        write_media_main(out, model);
    fprintf(out, "    signature = %s;\n}\n",
            model->features.has_objects || model->features.has_media ? "pixel_shown()" : "0u");
}
