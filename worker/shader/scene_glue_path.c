// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_path.h"

#include "core/job/job.h"
#include "worker/model/scene_model.h"
#include "worker/shader/scene_glue_gather.h"
#include "worker/shader/scene_glue_light.h"

#include <math.h>

// Writes the transmittance of the media between `from` and `to`. Without dielectrics there is one region.
static void write_piece(FILE *out, const struct scene_model *model)
{
    bool has_regions = model->features.has_dielectrics;

    if (!model->features.has_extinction) return;
    fprintf(out, "        %s ", has_regions ? "passed *=" : "return");
    scene_glue_write_transmittance(out, model,
                                   has_regions ? "media_spans_in(spans, before, vec2(from, to))"
                                               : "media_spans(point, light.direction)",
                                   has_regions ? "to" : "light.distance");
    fputs(";\n", out);
}

// Only opaque objects are there: the first one that is hit ends the shadow ray. A lamp on a surface is before it.
static void write_opaque_shadow(FILE *out, const struct scene_model *model)
{
    fputs("        float at = surface_next(shapes, 0.0, inside, left).at;\n"
          "        if (shape_spans_limit(shapes, at, 1.0) < light.distance) return spectrum(0.0);\n",
          out);
    if (model->features.has_extinction)
        write_piece(out, model);
    else
        fputs("        return spectrum(1.0);\n", out);
}

static bool has_opaque(const struct scene_features *features)
{
    for (size_t i = 0; i < features->object_count; ++i)
        if (features->objects[i].is_opaque) return true;
    return false;
}

// One loop goes over all boundaries, visible or not: software GL counts its iterations.
static void write_regions_shadow(FILE *out, const struct scene_model *model)
{
    if (model->features.has_extinction) fputs("    MediaSpans spans = media_spans(point, light.direction);\n", out);
    fputs("    Spectrum passed = spectrum(1.0);\n    float from = 0.0;\n"
          "    for (int iteration = 0; iteration < MARCH_LIMIT; ++iteration) {\n"
          "        SurfaceCrossing next = surface_next(shapes, from, inside, left);\n"
          "        bool is_there = shape_spans_limit(shapes, next.at, 1.0) >= light.distance;\n"
          "        int before = surface_region(inside);\n        int after = surface_region(next.inside);\n",
          out);
    if (has_opaque(&model->features))
        fputs("        if (!is_there && surface_is_opaque(after)) return spectrum(0.0);\n", out);
    fputs("        float to = min(next.at, light.distance);\n", out);
    write_piece(out, model);
    fputs("        if (is_there) return passed;\n"
          "        vec3 normal = shape_normal(findMSB(next.shapes), point + next.at * light.direction);\n"
          "        float ior_before = surface_ior(before);\n        float ior_after = surface_ior(after);\n"
          "        float eta = min(ior_before, ior_after) / max(ior_before, ior_after);\n"
          "        float fresnel = surface_fresnel(max(before, after), abs(dot(light.direction, normal)), eta);\n"
          "        if (before != after) passed *= 1.0 - fresnel;\n"
          "        from = next.at;\n        inside = next.inside;\n    }\n"
          "    march_was_cut = true;\n    return passed;\n",
          out);
}

void scene_glue_write_shadow(FILE *out, const struct scene_model *model)
{
    fputs("Spectrum shadow(vec3 point, LightSample light, uint inside, uint left)\n{\n"
          "    ShapeSpans shapes = shape_spans(point, light.direction);\n",
          out);
    if (model->features.has_dielectrics)
        write_regions_shadow(out, model);
    else
        write_opaque_shadow(out, model);
    fputs("}\n", out);
}

static bool sees_behind(const struct scene_model *model)
{
    return model->features.has_transmittance || !scene_has_behind(&model->job->scene);
}

// Room for the rays that wait: a power of two, so that paths of several lengths share a program.
static void write_path_room(FILE *out, int max_depth)
{
    int room = 1;

    while (room < max_depth)
        room *= 2;
    fprintf(out, "const int PATH_ROOM = %d;\n", room);
}

void scene_glue_write_seen(FILE *out, const struct scene_model *model)
{
    if (model->features.has_paths) write_path_room(out, model->job->quality.max_depth);
    fputs("// Sums over a sample's rays so far: light, the throughput of rays that leave the scene without a "
          "reflection,\n"
          "// and the distance of the first hit.\n"
          "Spectrum path_radiance = Spectrum(0.0);\n",
          out);
    if (sees_behind(model)) fputs("Spectrum path_behind = Spectrum(0.0);\n", out);
    if (model->features.has_depth) fputs("float path_depth = 0.0;\n", out);
}

static void write_clip(FILE *out, const struct scene_camera *camera)
{
    fprintf(out, "vec2(max(%.9e - ray.travelled, 0.0), ", camera->clip_near);
    if (isfinite(camera->clip_far))
        fprintf(out, "min(end, %.9e - ray.travelled))", camera->clip_far);
    else
        fputs("end)", out);
}

static void write_media(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    fputs("    int region = surface_region(ray.inside);\n"
          "    MediaSpans spans = media_spans_in(media_spans(ray.origin, ray.direction), region, ",
          out);
    write_clip(out, &model->job->scene.camera);
    fputs(");\n    pixel_sign(media_met(spans));\n    Gathered gathered = Gathered(path_radiance, ray.throughput", out);
    // Only the camera's own ray has a depth. 0 is "none yet", a negative number is "never".
    if (features->has_depth && features->has_extinction)
        fputs(features->has_paths ? ", ray.depth == 0 ? 0.0 : -1.0" : ", 0.0", out);
    fputs(", quality_min_transmittance * spectrum_max(ray.throughput)", out);
    fputs(features->media_are_lit ? ", region);\n" : ");\n", out);
    scene_glue_write_integrator(out, model, "ray.origin, ray.direction, media_interval(spans)");
    if (features->has_extinction)
        fputs(
            "    if (spectrum_mean(gathered.transmittance) < spectrum_mean(ray.throughput)) pixel_is_dimmed = true;\n",
            out);
    // Light behind the point where a ray is over counts for nothing.
    fputs(
        "    path_radiance = gathered.radiance;\n"
        "    ray.throughput = end < FAR_AWAY && gathered_is_over(gathered) ? spectrum(0.0) : gathered.transmittance;\n",
        out);
}

static void write_gather(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    fputs("// The media of the ray's region, up to `end`.\nvoid path_gather(inout PathRay ray, float end)\n{\n", out);
    if (features->has_media) write_media(out, model);
    if (features->has_depth) {
        fputs("    if (ray.depth == 0) path_depth = ", out);
        if (features->has_media && features->has_extinction) fputs("gathered.depth > 0.0 ? gathered.depth : ", out);
        fputs("end < FAR_AWAY ? end : 0.0;\n", out);
    }
    fputs("}\n", out);
}

// One loop over the lights compiles the shadow ray once: drivers copy functions to where they are called.
static void write_lit(FILE *out, const struct scene *scene, const struct scene_features *features)
{
    size_t iteration = 0, count = scene_features_count_lights(features);

    fputs("// Irradiance of the side to which the normal points, over pi.\n"
          "Spectrum surface_lit(vec3 point, vec3 normal, uint inside, uint shapes)\n{\n"
          "    Spectrum sum = spectrum(0.0);\n",
          out);
    fprintf(out, "    for (int iteration = 0; iteration < %zu; ++iteration) {\n        LightSample light;\n", count);
    for (size_t i = 0; i < scene->light_count; ++i)
        if (features->light_is_seen[i])
            fprintf(out, "        if (iteration == %zu) light = light_%zu(point);\n", iteration++, i);
    fputs("        float cos_light = dot(normal, light.direction);\n"
          "        if (cos_light > 0.0) sum += light.irradiance * (cos_light * shadow(point, light, inside,\n"
          "            surface_left(shapes, point, light.direction)));\n"
          "    }\n    return sum * (4.0 * INV_4PI);\n}\n",
          out);
}

void scene_glue_write_albedo(FILE *out, const struct scene_model *model)
{
    const struct scene *scene = &model->job->scene;
    const struct scene_features *features = &model->features;

    fputs("Spectrum surface_albedo(int object, vec3 point, int shape)\n{\n", out);
    for (size_t i = 0; i < features->object_count; ++i) {
        if (!features->objects[i].is_lit) continue;
        fprintf(out, "    if (object == %zu) return object_%zu_albedo", i + 1, i);
        if (scene->objects[i].material.texture.file) fprintf(out, " * object_%zu_texture(point, shape)", i);
        fputs(";\n", out);
    }
    fputs("    return spectrum(0.0);\n}\n", out);
}

static void write_reflected(FILE *out, const struct scene *scene, const struct scene_features *features)
{
    fprintf(out, "Spectrum surface_reflected(int object%s)\n{\n", features->has_fresnel ? ", float fresnel" : "");
    for (size_t i = 0; i < features->object_count; ++i) {
        const struct object_features *object = &features->objects[i];
        enum scene_material_kind kind = scene->objects[i].material.kind;

        if (!object->reflects) continue;
        fprintf(out, "    if (object == %zu) return ", i + 1);
        if (kind == SCENE_MATERIAL_MIRROR)
            fprintf(out, "object_%zu_reflectance;\n", i);
        else if (kind == SCENE_MATERIAL_DIFFUSE)
            fprintf(out, "spectrum(object_%zu_specular * fresnel);\n", i);
        else
            fputs("spectrum(fresnel);\n", out);
    }
    fputs("    return spectrum(0.0);\n}\n", out);
}

static void write_answer_rays(FILE *out, const struct scene_features *features)
{
    fprintf(out, "    vec3 facet = %s;\n",
            features->has_roughness ? "rough_normal(normal, ray.direction, surface_roughness(object))" : "normal");
    fputs("    float cos_in = clamp(-dot(ray.direction, facet), 0.0, 1.0);\n", out);
    if (features->has_fresnel)
        fputs("    float eta = surface_ior(before) / surface_ior(after);\n"
              "    float fresnel = surface_fresnel(object, cos_in, eta);\n",
              out);
    fprintf(out, "    Spectrum reflected = surface_reflected(object%s);\n", features->has_fresnel ? ", fresnel" : "");
    fprintf(out,
            "    vec3 mirrored = %sray.direction + 2.0 * cos_in * facet%s;\n"
            "    path_send(PathRay(point, normalize(mirrored), ray.throughput * reflected, travelled, ray.depth + 1, "
            "hit.before, "
            "hit.shapes, false));\n",
            features->has_roughness ? "rough_side(" : "", features->has_roughness ? ", normal, 1.0)" : "");
    if (!features->has_dielectrics) return;
    fputs("    if (!surface_is_opaque(after)) {\n"
          "        float cos_out = max(snell_cos(cos_in, eta), 0.0);\n",
          out);
    fprintf(out, "        vec3 refracted = %ssnell_refract(ray.direction, facet, cos_in, cos_out, eta)%s;\n",
            features->has_roughness ? "rough_side(" : "", features->has_roughness ? ", normal, -1.0)" : "");
    fputs("        path_send(PathRay(point, refracted, ray.throughput * (1.0 - fresnel), travelled, ray.depth + 1, "
          "hit.after, "
          "hit.shapes, ray.is_direct));\n    }\n",
          out);
}

static void write_answer(FILE *out, const struct scene_features *features)
{
    fputs("// Lights, reflects and refracts a ray at the boundary that it meets.\nvoid path_answer(PathRay ray, "
          "SurfaceHit hit)\n{\n",
          out);
    if (!features->has_paths && !features->surfaces_are_lit) {
        fputs("}\n", out);
        return;
    }
    fprintf(out,
            "    int before = surface_region(hit.before);\n    int after = surface_region(hit.after);\n"
            "    int object = %s;\n    int shape = findMSB(hit.shapes);\n"
            "    vec3 point = ray.origin + hit.at * ray.direction;\n"
            "    float travelled = ray.travelled + hit.at;\n"
            "    vec3 normal = shape_normal(shape, point);\n"
            "    if (dot(ray.direction, normal) > 0.0) normal = -normal;\n",
            features->has_dielectrics ? "surface_is_opaque(after) ? after : max(before, after)" : "after");
    if (features->has_paths) write_answer_rays(out, features);
    if (features->surfaces_are_lit) {
        fputs("    Spectrum albedo = surface_albedo(object, point, shape);\n"
              "    if (spectrum_max(albedo * ray.throughput) > 0.0)\n"
              "        path_radiance += ray.throughput * ",
              out);
        if (features->has_paths) fputs("(1.0 - reflected) * ", out);
        fputs("albedo * surface_lit(point, normal, hit.before, hit.shapes);\n", out);
    }
    fputs("}\n", out);
}

static void write_escape(FILE *out, const struct scene_model *model)
{
    fputs("void path_escape(PathRay ray)\n{\n", out);
    if (model->features.has_background) {
        fputs("    path_radiance += ray.throughput * ", out);
        scene_glue_light_write_behind(out, model, "ray.direction");
        fputs(";\n", out);
    }
    if (sees_behind(model)) fputs("    if (ray.is_direct) path_behind += ray.throughput;\n", out);
    fputs("}\n", out);
}

void scene_glue_write_path(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    write_gather(out, model);
    if (features->surfaces_are_lit) {
        write_lit(out, &model->job->scene, features);
        scene_glue_write_albedo(out, model);
    }
    if (features->has_paths) write_reflected(out, &model->job->scene, features);
    write_answer(out, features);
    write_escape(out, model);
}

void scene_glue_write_path_start(FILE *out, const struct scene_model *model)
{
    fprintf(out,
            "    uint inside = surface_around(shape_spans(camera.position, direction));\n"
            "    // A camera in an opaque object sees nothing.\n"
            "    Spectrum throughput = spectrum(surface_is_opaque(surface_region(inside)) ? 0.0 : 1.0);\n"
            "    path_%s(PathRay(camera.position, direction, throughput, 0.0, 0, inside, 0u, true));\n",
            model->features.has_paths ? "trace" : "follow");
}
