// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_slice.h"

#include "worker/model/scene_model.h"

void scene_glue_write_slice_random(FILE *out, const struct scene_model *model)
{
    fprintf(out, "uint slice_random_now()\n{\n    return %s;\n}\n", model->features.is_random ? "random_state" : "0u");
}

static void write_load(FILE *out, const struct scene_features *features)
{
    const char *spectrum = features->is_rgb ? "xyz" : "x";

    fputs("bool slice_load()\n{\n    ivec2 pixel = ivec2(gl_FragCoord.xy);\n"
          "    uvec4 light = imageLoad(slice_light, pixel);\n    uvec4 transmittance = imageLoad(slice_transmittance, "
          "pixel);\n"
          "    uvec4 marks = imageLoad(slice_marks, pixel);\n",
          out);
    fprintf(out, "    slice_gathered.radiance = uintBitsToFloat(light.%s);\n", spectrum);
    if (features->has_throughput)
        fprintf(out, "    slice_gathered.transmittance = uintBitsToFloat(transmittance.%s);\n", spectrum);
    if (features->has_extinction && features->has_depth)
        fputs("    slice_gathered.depth = uintBitsToFloat(marks.z);\n", out);
    fputs("    slice_position = uintBitsToFloat(uvec2(light.w, transmittance.w));\n    slice_random = marks.y;\n"
          "    slice_waits = marks.w;\n    slice_is_begun = marks.x == SLICE_IS_BEGUN;\n"
          "    return marks.x != SLICE_IS_DONE;\n}\n",
          out);
}

static void write_store(FILE *out, const struct scene_features *features)
{
    bool has_depth = features->has_extinction && features->has_depth;

    fprintf(out,
            "bool slice_store(bool is_paused)\n{\n    ivec2 pixel = ivec2(gl_FragCoord.xy);\n"
            "    uint waits = slice_has_moved() ? 0u : slice_waits + 1u;\n"
            "    bool is_done = !is_paused || waits >= SLICE_WAIT_LIMIT;\n"
            "    imageStore(slice_marks, pixel, uvec4(is_done ? SLICE_IS_DONE : SLICE_IS_BEGUN, slice_random, %s, "
            "waits));\n"
            "    if (is_done) return true;\n",
            has_depth ? "floatBitsToUint(slice_gathered.depth)" : "0u");
    fputs("    imageStore(slice_light, pixel, floatBitsToUint(vec4(spectrum_rgb(slice_gathered.radiance), "
          "slice_position.x)));\n",
          out);
    fprintf(out,
            "    imageStore(slice_transmittance, pixel, floatBitsToUint(vec4(%s, slice_position.y)));\n    return "
            "false;\n}\n",
            features->has_throughput ? "spectrum_rgb(slice_gathered.transmittance)" : "vec3(1.0)");
}

void scene_glue_write_slice(FILE *out, const struct scene_model *model)
{
    fputs(
        "layout(rgba32ui, binding = 0) uniform uimage2D slice_light;\n"
        "layout(rgba32ui, binding = 1) uniform uimage2D slice_transmittance;\n"
        "layout(rgba32ui, binding = 2) uniform uimage2D slice_marks;\n"
        "const uint SLICE_IS_BEGUN = 1u;\nconst uint SLICE_IS_DONE = 2u;\n"
        "// Rays that share a SIMD unit share its iterations: a ray that got none may come further in the next slice.\n"
        "const uint SLICE_WAIT_LIMIT = 2u;\nuint slice_waits;\n",
        out);
    write_load(out, &model->features);
    write_store(out, &model->features);
}
