// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_surface.h"

#include "core/job/job.h"
#include "worker/model/scene_model.h"

static const struct {
    const char *name, *type, *second;
} shape_kinds[] = {
    [SCENE_SHAPE_SPHERE] = {"sphere", "RegionSphere", "radius"},
    [SCENE_SHAPE_BOX] = {"box", "RegionBox", "half_size"},
    [SCENE_SHAPE_PLANE] = {"plane", "RegionPlane", "normal"},
};

static void write_shapes(FILE *out, const struct scene *scene)
{
    for (size_t i = 0; i < scene->shape_count; ++i) {
        enum scene_shape_kind kind = scene->shapes[i].kind;

        fprintf(out, "%s shape_%zu()\n{\n    return %s(shape_%zu_center, shape_%zu_%s);\n}\n", shape_kinds[kind].type,
                i, shape_kinds[kind].type, i, i, shape_kinds[kind].second);
    }
}

// Boundaries that lie this close count as one: some last digits of the coordinates that they follow from.
static void write_spans(FILE *out, const struct scene *scene)
{
    fputs("struct ShapeSpans { vec3 origin, direction; float sliver;", out);
    for (size_t i = 0; i < scene->shape_count; ++i)
        fprintf(out, " vec2 shape_%zu;", i);
    fputs(" };\nShapeSpans shape_spans(vec3 origin, vec3 direction)\n{\n"
          "    vec3 digits = abs(origin) + abs(camera_position);\n"
          "    return ShapeSpans(origin, direction, 2e-7 * (digits.x + digits.y + digits.z)",
          out);
    for (size_t i = 0; i < scene->shape_count; ++i)
        fprintf(out, ",\n        region_%s_span(shape_%zu(), origin, direction)",
                shape_kinds[scene->shapes[i].kind].name, i);
    fputs(");\n}\n"
          "// Boundaries up to there coincide with one at `at`, where the cosine to the normal is `slope`.\n"
          "float shape_spans_limit(ShapeSpans spans, float at, float slope)\n{\n"
          "    return at + (spans.sliver + 2e-7 * at) / slope;\n}\n",
          out);
}

static void write_normal(FILE *out, const struct scene *scene)
{
    fputs("vec3 shape_normal(int shape, vec3 p)\n{\n", out);
    for (size_t i = 0; i < scene->shape_count; ++i) {
        if (i + 1 < scene->shape_count) fprintf(out, "    if (shape == %zu)\n    ", i);
        if (scene->shapes[i].kind == SCENE_SHAPE_PLANE)
            fprintf(out, "    return shape_%zu_normal;\n", i);
        else
            fprintf(out, "    return surface_%s_normal(shape_%zu(), p);\n", shape_kinds[scene->shapes[i].kind].name, i);
    }
    fputs("}\n", out);
}

static void write_around(FILE *out, const struct scene *scene)
{
    fputs("uint surface_around(ShapeSpans spans)\n{\n    uint inside = 0u;\n", out);
    for (size_t i = 0; i < scene->object_count; ++i) {
        const struct scene_object *object = &scene->objects[i];

        fputs("    if (", out);
        for (size_t k = 0; k < object->shape_count; ++k)
            fprintf(out, "%sspan_has(spans.shape_%zu, 0.0)", k > 0 ? " || " : "", object->first_shape + k);
        fprintf(out, ") inside |= %uu;\n", 1U << i);
    }
    fputs("    return inside;\n}\n", out);
}

// Writes the boundary of a single shape beyond `from`: its exit or its entry.
static void write_single(FILE *out, const struct scene_object *object, size_t i)
{
    size_t shape = object->first_shape;

    fprintf(out,
            "    uint shape_%zu = %uu;\n"
            "    float at_%zu = (inside & %uu) != 0u ? max(spans.shape_%zu.y, from)\n"
            "        : (left & %uu) != 0u ? FAR_AWAY : surface_entry(spans.shape_%zu, from, limit);\n",
            i, 1U << shape, i, 1U << i, shape, 1U << shape, shape);
}

static void write_extension(FILE *out, const char *indent, size_t shape)
{
    fprintf(out, "%sif (spans.shape_%zu.x <= shape_spans_limit(spans, at, 1.0) && spans.shape_%zu.y > at) {\n", indent,
            shape, shape);
    fprintf(out, "%s    at = spans.shape_%zu.y;\n%s    shape = %uu;\n%s}\n", indent, shape, indent, 1U << shape,
            indent);
}

// Writes the exit of a union: through the shape that holds the point and all that follow without a gap.
static void write_union_exit(FILE *out, const struct scene_object *object, size_t i)
{
    size_t first = object->first_shape, end = first + object->shape_count;

    fprintf(out,
            "float object_%zu_exit(ShapeSpans spans, float from, out uint shape)\n{\n"
            "    float begin = FAR_AWAY;\n    float at = from;\n    shape = %uu;\n",
            i, 1U << first);
    for (size_t k = first; k < end; ++k)
        fprintf(out,
                "    if (spans.shape_%zu.y > from && spans.shape_%zu.x < begin) {\n        begin = spans.shape_%zu.x;\n"
                "        at = spans.shape_%zu.y;\n        shape = %uu;\n    }\n",
                k, k, k, k, 1U << k);
    fprintf(out, "    for (int i = 1; i < %zu; ++i) {\n        float before = at;\n", object->shape_count);
    for (size_t k = first; k < end; ++k)
        write_extension(out, "        ", k);
    fputs("        if (at <= before) break;\n    }\n    return at;\n}\n", out);
}

static void write_union_entry(FILE *out, const struct scene_object *object, size_t i)
{
    size_t first = object->first_shape, end = first + object->shape_count;

    fprintf(out,
            "float object_%zu_entry(ShapeSpans spans, float from, uint left, out uint shape)\n{\n"
            "    float limit = shape_spans_limit(spans, from, SURFACE_FLATTEST);\n    float at = FAR_AWAY;\n    float "
            "entry;\n"
            "    shape = %uu;\n",
            i, 1U << first);
    for (size_t k = first; k < end; ++k)
        fprintf(out,
                "    entry = (left & %uu) != 0u ? FAR_AWAY : surface_entry(spans.shape_%zu, from, limit);\n"
                "    if (entry < at) {\n        at = entry;\n        shape = %uu;\n    }\n",
                1U << k, k, 1U << k);
    fputs("    return at;\n}\n", out);
}

static void write_union(FILE *out, size_t i)
{
    fprintf(out,
            "    uint shape_%zu;\n    float at_%zu;\n"
            "    if ((inside & %uu) != 0u) at_%zu = object_%zu_exit(spans, from, shape_%zu);\n"
            "    else at_%zu = object_%zu_entry(spans, from, left, shape_%zu);\n",
            i, i, 1U << i, i, i, i, i, i, i);
}

// Writes the nearest of all boundaries and those that coincide with it. Rounding moves a boundary that a ray meets at a
// small angle much further along the ray.
static void write_nearest(FILE *out, const struct scene *scene)
{
    fputs("    float at = at_0;\n    uint nearest = shape_0;\n", out);
    for (size_t i = 1; i < scene->object_count; ++i)
        fprintf(out, "    if (at_%zu < at) {\n        at = at_%zu;\n        nearest = shape_%zu;\n    }\n", i, i, i);
    fputs("    if (at >= FAR_AWAY) return SurfaceCrossing(FAR_AWAY, inside, 0u);\n"
          "    limit = shape_spans_limit(spans, at, SURFACE_FLATTEST);\n    int met = 0;\n",
          out);
    for (size_t i = 0; i < scene->object_count; ++i)
        fprintf(out, "    if (at_%zu <= limit) ++met;\n", i);
    fputs("    if (met > 1) {\n"
          "        vec3 normal = shape_normal(findMSB(nearest), spans.origin + at * spans.direction);\n"
          "        float slope = max(abs(dot(spans.direction, normal)), SURFACE_FLATTEST);\n"
          "        limit = shape_spans_limit(spans, at, slope);\n    }\n",
          out);
}

static void write_next(FILE *out, const struct scene *scene)
{
    for (size_t i = 0; i < scene->object_count; ++i) {
        if (scene->objects[i].shape_count < 2) continue;
        write_union_exit(out, &scene->objects[i], i);
        write_union_entry(out, &scene->objects[i], i);
    }
    fputs("SurfaceCrossing surface_next(ShapeSpans spans, float from, uint inside, uint left)\n{\n"
          "    float limit = shape_spans_limit(spans, from, SURFACE_FLATTEST);\n",
          out);
    for (size_t i = 0; i < scene->object_count; ++i)
        if (scene->objects[i].shape_count < 2)
            write_single(out, &scene->objects[i], i);
        else
            write_union(out, i);
    write_nearest(out, scene);
    fputs("    uint crossed = 0u;\n    uint shapes = 0u;\n", out);
    for (size_t i = 0; i < scene->object_count; ++i)
        fprintf(out, "    if (at_%zu <= limit) {\n        crossed |= %uu;\n        shapes |= shape_%zu;\n    }\n", i,
                1U << i, i);
    fputs("    return SurfaceCrossing(at, inside ^ crossed, shapes);\n}\n", out);
}

static void write_opaque(FILE *out, const struct scene_features *features)
{
    unsigned opaque = 0;

    for (size_t i = 0; i < features->object_count; ++i)
        if (features->objects[i].is_opaque) opaque |= 1U << (i + 1);
    fprintf(out, "bool surface_is_opaque(int region)\n{\n    return ((%uu >> uint(region)) & 1u) != 0u;\n}\n", opaque);
}

static void write_ior(FILE *out, const struct scene_features *features)
{
    fputs("float surface_ior(int region)\n{\n", out);
    for (size_t i = 0; i < features->object_count; ++i)
        if (features->objects[i].has_fresnel) fprintf(out, "    if (region == %zu) return object_%zu_ior;\n", i + 1, i);
    fputs("    return 1.0;\n}\n", out);
}

static bool uses_fresnel(const struct scene_model *model, size_t i, enum scene_fresnel fresnel)
{
    return model->features.objects[i].has_fresnel && model->job->scene.objects[i].material.fresnel == fresnel;
}

static bool scene_uses_fresnel(const struct scene_model *model, enum scene_fresnel fresnel)
{
    for (size_t i = 0; i < model->features.object_count; ++i)
        if (uses_fresnel(model, i, fresnel)) return true;
    return false;
}

static void write_schlick(FILE *out, const struct scene_model *model)
{
    // (a - b)^2 / (a + b)^2 of two iors is that of their ratio and 1.
    fputs("    float ratio = (eta - 1.0) / (eta + 1.0);\n    FresnelSchlick schlick = FresnelSchlick(-1.0, 1.0);\n",
          out);
    for (size_t i = 0; i < model->features.object_count; ++i)
        if (uses_fresnel(model, i, SCENE_FRESNEL_SCHLICK)) {
            fprintf(out, "    if (object == %zu) schlick = FresnelSchlick(", i + 1);
            if (model->job->scene.objects[i].material.has_f0)
                fprintf(out, "object_%zu_f0", i);
            else
                fputs("ratio * ratio", out);
            fprintf(out, ", object_%zu_f90);\n", i);
        }
    fputs("    if (schlick.f0 >= 0.0) return fresnel_schlick(schlick, cos_in, eta);\n", out);
}

static void write_none(FILE *out, const struct scene_model *model)
{
    for (size_t i = 0; i < model->features.object_count; ++i)
        if (uses_fresnel(model, i, SCENE_FRESNEL_NONE)) {
            fprintf(out, "    if (object == %zu) return ", i + 1);
            // A diffuse material's specular share reflects as a mirror does.
            fputs(model->features.objects[i].is_opaque ? "1.0;\n" : "fresnel_none(cos_in, eta);\n", out);
        }
}

// Each kind of Fresnel term is called once: drivers copy functions to where they are called.
static void write_fresnel(FILE *out, const struct scene_model *model)
{
    bool has_exact = scene_uses_fresnel(model, SCENE_FRESNEL_EXACT);

    fputs("float surface_fresnel(int object, float cos_in, float eta)\n{\n", out);
    if (scene_uses_fresnel(model, SCENE_FRESNEL_SCHLICK)) write_schlick(out, model);
    if (scene_uses_fresnel(model, SCENE_FRESNEL_NONE)) write_none(out, model);
    fprintf(out, "    return %s;\n}\n", has_exact ? "fresnel_exact(cos_in, eta)" : "0.0");
}

static void write_roughness(FILE *out, const struct scene_features *features)
{
    fputs("float surface_roughness(int object)\n{\n", out);
    for (size_t i = 0; i < features->object_count; ++i)
        if (features->objects[i].is_rough)
            fprintf(out, "    if (object == %zu) return object_%zu_roughness;\n", i + 1, i);
    fputs("    return 0.0;\n}\n", out);
}

void scene_glue_write_surfaces(FILE *out, const struct scene_model *model)
{
    const struct scene *scene = &model->job->scene;
    const struct scene_features *features = &model->features;

    write_shapes(out, scene);
    write_spans(out, scene);
    write_normal(out, scene);
    write_around(out, scene);
    write_next(out, scene);
    write_opaque(out, features);
    if (features->has_fresnel) {
        write_ior(out, features);
        write_fresnel(out, model);
    }
    if (features->has_roughness) write_roughness(out, features);
}
