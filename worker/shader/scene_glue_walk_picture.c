// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_walk_picture.h"

#include "core/job/job.h"
#include "worker/glsl/walk_count.h"
#include "worker/model/scene_model.h"
#include "worker/shader/scene_glue_light.h"

#include <math.h>

// `marks` holds the scatterings so far in 10 bits, up to 1023 of them, then the path's number, counted from 1 on. Rays
// that are followed for their transmittance begin on no boundary: in place of these they have a number of depths.
void scene_glue_write_walk_slice(FILE *out, const struct scene_model *model)
{
    const char *spectrum = model->features.is_rgb ? "xyz" : "x";

    fputs("layout(rgba32ui, binding = 0) uniform uimage2D slice_light;\n"
          "layout(rgba32ui, binding = 1) uniform uimage2D slice_passed;\n"
          "layout(rgba32ui, binding = 2) uniform uimage2D slice_origin;\n"
          "layout(rgba32ui, binding = 4) uniform uimage2D slice_direction;\n"
          "layout(rgba32ui, binding = 5) uniform uimage2D slice_weight;\n",
          out);
    fprintf(out,
            "layout(std430, binding = %d) buffer WalkCount { uint walk_taken; uint walk_ended; };\n"
            "const uint WALK_STEPS = %uu; // that count as one\n"
            "uint walk_share(int path, int passes, int paths)\n{\n"
            "    return uint(%d * max(path + passes, 0) / (passes + paths));\n}\n",
            WALK_COUNT_BUFFER, WALK_COUNT_STEPS, WALK_COUNT_SHARES);
    fputs("const uint WALK_IS_DONE = 0xffffffffu;\n"
          "bool walk_load(inout Walk walk, int passes)\n{\n    ivec2 place = ivec2(gl_FragCoord.xy);\n"
          "    uvec4 light = imageLoad(slice_light, place);\n"
          "    if (light.w == 0u) return true;\n    if (light.w == WALK_IS_DONE) return false;\n"
          "    uvec4 passed = imageLoad(slice_passed, place);\n    uvec4 origin = imageLoad(slice_origin, place);\n"
          "    uvec4 direction = imageLoad(slice_direction, place);\n"
          "    uvec4 weight = imageLoad(slice_weight, place);\n",
          out);
    fprintf(out,
            "    walk = Walk(uintBitsToFloat(light.%s), uintBitsToFloat(passed.%s),\n"
            "                vec2(uintBitsToFloat(passed.w), 0.0), int(light.w >> 10u) - passes - 1,\n"
            "                int(light.w & 1023u), uintBitsToFloat(origin.xyz), uintBitsToFloat(direction.xyz),\n"
            "                uintBitsToFloat(weight.w), uintBitsToFloat(weight.%s), direction.w,\n"
            "                WALK_SENDS ? 0u : origin.w, WALK_SENDS ? uintBitsToFloat(origin.w) : 0.0);\n"
            "    if (walk.path < 0) {\n        walk.depth.y = uintBitsToFloat(origin.w);\n        walk.left = 0u;\n"
            "        walk.aimed = 0.0;\n"
            "    } else {\n        walk.depth.y = walk.depth.x > 0.0 ? 1.0 : 0.0;\n    }\n"
            "    return true;\n}\n",
            spectrum, spectrum, spectrum);
    fputs("void walk_store(Walk walk, int passes, bool is_done)\n{\n    ivec2 place = ivec2(gl_FragCoord.xy);\n"
          "    atomicAdd(walk_taken, (walk_steps + uint(place.x + 4 * place.y) % WALK_STEPS) / WALK_STEPS);\n"
          "    uint marks = is_done ? WALK_IS_DONE : (uint(walk.path + passes + 1) << 10u) | uint(min(walk.order, "
          "1023));\n"
          "    imageStore(slice_light, place, uvec4(floatBitsToUint(spectrum_rgb(walk.light)), marks));\n"
          "    if (is_done) return;\n"
          "    imageStore(slice_passed, place, floatBitsToUint(vec4(spectrum_rgb(walk.passed), walk.depth.x)));\n"
          "    uint kept = WALK_SENDS ? floatBitsToUint(walk.aimed) : walk.left;\n"
          "    if (walk.path < 0) kept = floatBitsToUint(walk.depth.y);\n"
          "    imageStore(slice_origin, place, uvec4(floatBitsToUint(walk.origin), kept));\n"
          "    imageStore(slice_direction, place, uvec4(floatBitsToUint(walk.direction), walk.random));\n"
          "    imageStore(slice_weight, place, floatBitsToUint(vec4(spectrum_rgb(walk.weight), walk.at)));\n}\n",
          out);
}

// Whether paths tell what lies behind: a layer of scattered light leaves that to the one of what is seen.
static bool finds_passed(const struct scene_features *features)
{
    return (features->has_extinction || features->has_objects) && !features->is_scattered;
}

// Transmittance and depth are estimated by a fraction of the paths' number. Where light comes from behind, the noise of
// its transmittance is the picture's, and falls with the paths' number, however large.
static void write_sums(FILE *out, const struct scene_model *model)
{
    const struct scene_camera *camera = &model->job->scene.camera;
    bool dims = finds_passed(&model->features);
    const char *rays = !dims ? "0" : model->features.has_background ? "max(paths / 4, 1)" : "clamp(paths / 4, 1, 256)";

    fputs("    MediaSpans spans = media_spans(camera.position, direction);\n    pixel_sign(media_met(spans));\n", out);
    fprintf(out, "    vec2 clip = vec2(%.9e, ", camera->clip_near);
    if (isfinite(camera->clip_far))
        fprintf(out, "%.9e);\n", camera->clip_far);
    else
        fputs("FAR_AWAY);\n", out);
    fprintf(out,
            "    walk_pixel = pixel;\n    walk_camera = WalkRay(camera.position, direction, clip);\n"
            "    int paths = int(quality_paths);\n    int passes = %s;\n"
            "    vec2 interval = span_meet(media_interval(spans), clip);\n"
            "    Walk walk = walk_none(passes);\n    if (!walk_load(walk, passes)) discard;\n"
            "    uint before = walk_share(walk.path, passes, paths);\n%s"
            "    bool is_done = walk_on(walk, passes, paths, %d);\n    walk_store(walk, passes, is_done);\n"
            "    atomicAdd(walk_ended, walk_share(walk.path, passes, paths) - before);\n"
            "    march_was_cut = march_was_cut || path_iterations_are_spent();\n"
            "    if (!is_done && !march_was_cut) discard;\n",
            rays,
            model->features.has_objects
                ? "    // A camera in an opaque object sees nothing.\n"
                  "    if (surface_around(shape_spans(camera.position, direction)) != 0u) walk.path = paths;\n"
                  "    pixel_sign(walk_wall(camera.position, direction, 0u).shapes);\n"
                : "    if (!(interval.x < interval.y && interval.y > 0.0)) {\n"
                  "        walk.passed = spectrum(float(passes));\n        walk.path = paths;\n    }\n",
            model->job->scene.orders);
    fputs("    Spectrum light = walk.light / float(paths);\n", out);
    fprintf(out, "    Spectrum passed = %s;\n", dims ? "walk.passed / float(passes)" : "spectrum(1.0)");
    if (dims) fputs("    pixel_is_dimmed = spectrum_mean(passed) < 1.0;\n", out);
}

// Ends the colour of a layer of scattered light, and tells its noise. Its rays have no extinction but where media are.
static void write_noise(FILE *out)
{
    fputs("), 0.0);\n"
          "    transmittance = vec4(spectrum_rgb(2.0 * walk.passed - walk.light) / float(paths), 0.0);\n"
          "    pixel_is_dimmed = interval.x < interval.y && interval.y > 0.0;\n",
          out);
}

void scene_glue_write_walk_picture(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    write_sums(out, model);
    fputs("    rgba = vec4(spectrum_rgb(light", out);
    if (features->has_background) {
        fputs(" + passed * ", out);
        scene_glue_light_write_behind(out, model, "direction");
    }
    if (features->is_scattered) {
        write_noise(out);
    } else {
        fprintf(out, "), %s);\n", scene_has_behind(&model->job->scene) ? "1.0" : "1.0 - spectrum_mean(passed)");
        if (features->has_transmittance) fputs("    transmittance = vec4(spectrum_rgb(passed), 0.0);\n", out);
    }
    if (features->has_depth) {
        fputs("    float half_way = walk.depth.x;\n", out);
        if (model->job->quality.samples > 1)
            fputs("    depth = vec2(half_way / length(toward), half_way > 0.0 ? 1.0 : 0.0);\n", out);
        else
            fputs("    depth = half_way / length(toward);\n", out);
    }
    fputs("    if (march_was_cut) rgba.a = -1e6; // no picture has it, nor has a sum of them\n", out);
}
