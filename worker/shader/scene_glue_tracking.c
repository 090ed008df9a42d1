// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_tracking.h"

#include "core/job/job.h"
#include "worker/density/density_kind.h"
#include "worker/model/scene_model.h"
#include "worker/shader/integrators.h"
#include "worker/shader/scene_glue_media.h"

#include <string.h>

typedef bool choose_medium(const struct medium_features *medium);

static bool is_seen(const struct medium_features *medium)
{
    return medium->is_seen;
}

static void write_extinction(FILE *out, const struct scene_model *model)
{
    fputs("Spectrum media_extinction(MediaField field)\n{\n    Spectrum sum = spectrum(0.0);\n", out);
    for (size_t i = 0; i < model->features.medium_count; ++i) {
        if (!medium_features_have_column(&model->features.media[i])) continue;
        fprintf(out, "    sum += medium_%zu_sigma_t * (", i);
        scene_glue_write_density(out, model, i);
        fputs(");\n", out);
    }
    fputs("    return sum;\n}\n", out);
}

static const char *ray_type_of(const struct scene_model *model, size_t i)
{
    return model->features.media[i].is_seen ? density_kind_of(&scene_model_site(model, i).source->density)->ray_type
                                            : NULL;
}

static void write_ray(FILE *out, const struct scene_model *model)
{
    fputs("struct MediaRay {\n    vec3 origin, direction;\n", out);
    for (size_t i = 0; i < model->features.medium_count; ++i)
        if (ray_type_of(model, i)) fprintf(out, "    %s medium_%zu;\n", ray_type_of(model, i), i);
    fputs("};\n", out);
}

static void write_make_ray(FILE *out, const struct scene_model *model)
{
    fputs("MediaRay media_ray(vec3 origin, vec3 direction)\n{\n    return MediaRay(origin, direction", out);
    for (size_t i = 0; i < model->features.medium_count; ++i)
        if (ray_type_of(model, i)) fprintf(out, ", medium_%zu_ray(origin, direction)", i);
    fputs(");\n}\n", out);
}

// Writes medium_I_most: a bound on the density, and for how far along the ray it holds.
static void write_most(FILE *out, const struct scene_model *model, size_t i)
{
    const struct density_site site = scene_model_site(model, i);
    const struct density_kind *kind = density_kind_of(&site.source->density);

    if (kind->write_most)
        kind->write_most(out, &site);
    else
        fprintf(out,
                "float medium_%zu_most(MediaRay ray, float at, inout float extent)\n{\n"
                "    return medium_%zu_majorant;\n}\n",
                i, i);
}

// Writes the majorant summed over the chosen media. A medium without extinction only counts as present.
static void write_rate(FILE *out, const struct scene_model *model, choose_medium *choose)
{
    fputs("    float extent = edge - at;\n    bool is_there = false;\n    Spectrum sum = spectrum(0.0);\n", out);
    for (size_t i = 0; i < model->features.medium_count; ++i) {
        const struct medium_features *medium = &model->features.media[i];

        if (!choose(medium)) continue;
        fprintf(out,
                "    if (span_has(spans.medium_%zu, at)) {\n"
                "        float most = medium_%zu_most(ray, at, extent);\n"
                "        is_there = is_there || most > 0.0;\n",
                i, i);
        if (medium_features_have_column(medium)) fprintf(out, "        sum += medium_%zu_sigma_t * most;\n", i);
        fputs("    }\n", out);
    }
    fputs("    edge = min(edge, at + extent);\n", out);
}

static void write_columns(FILE *out, const struct scene_model *model)
{
    scene_glue_write_column_none(out, model);
    fputs("Spectrum media_column_extinction(MediaColumn column)\n{\n    Spectrum sum = spectrum(0.0);\n", out);
    for (size_t i = 0; i < model->features.medium_count; ++i)
        if (medium_features_march_to_lights(&model->features.media[i]))
            fprintf(out, "    sum += medium_%zu_sigma_t * column.medium_%zu;\n", i, i);
    fputs("    return sum;\n}\n", out);
    if (!model->features.has_majorants) return;
    fputs("float media_column_rate(MediaSpans spans, MediaRay ray, float at, inout float edge)\n{\n", out);
    write_rate(out, model, medium_features_march_to_lights);
    fputs("    return is_there ? spectrum_max(sum) : 0.0;\n}\n", out);
}

void scene_glue_write_tracking(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    write_extinction(out, model);
    if (features->has_majorants) {
        write_ray(out, model);
        for (size_t i = 0; i < features->medium_count; ++i)
            if (features->media[i].is_seen) write_most(out, model, i);
        write_make_ray(out, model);
        fputs("float media_rate(MediaSpans spans, MediaRay ray, float at, float least, inout float edge)\n{\n", out);
        write_rate(out, model, is_seen);
        fputs("    return is_there ? max(spectrum_max(sum), least) : 0.0;\n}\n", out);
    }
    if (features->estimates_columns) write_columns(out, model);
}

// Homogeneous media: their column is the length of the path in them times the density.
static void write_even(FILE *out, const struct scene_model *model)
{
    const char *separator = "";
    bool has_even = false;

    for (size_t i = 0; i < model->features.medium_count; ++i)
        has_even |= model->features.media[i].is_even && medium_features_have_column(&model->features.media[i]);
    if (!has_even) {
        fputs("    Spectrum transmittance = spectrum(1.0);\n", out);
        return;
    }
    fputs("    MediaColumn column = MediaColumn(", out);
    for (size_t i = 0; i < model->features.medium_count; ++i) {
        const struct medium_features *medium = &model->features.media[i];

        if (!medium_features_have_column(medium)) continue;
        fputs(separator, out);
        separator = ", ";
        if (medium->is_even)
            fprintf(out,
                    "max(min(spans.medium_%zu.y, interval.y) - max(spans.medium_%zu.x, interval.x), 0.0) * "
                    "medium_%zu_density(%s(0.0))",
                    i, i, i, density_kind_of(&model->job->scene.media[i].density)->field_type);
        else
            fputs("0.0", out);
    }
    fputs(");\n    Spectrum transmittance = media_transmittance(column);\n", out);
}

void scene_glue_write_estimate(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    fputs("Spectrum media_transmittance_estimate(MediaSpans spans, vec3 origin, vec3 direction, vec2 interval, float "
          "step)\n{\n",
          out);
    if (!features->has_extinction) {
        fputs("    return spectrum(1.0);\n}\n", out);
        return;
    }
    write_even(out, model);
    if (features->estimates_columns)
        fprintf(out,
                "    interval = span_meet(interval, media_column_interval(spans));\n"
                "    if (interval.x < interval.y) transmittance *= %sspans, origin, direction, interval%s);\n",
                integrator_to_lights(model)->call, features->has_majorants ? "" : ", step");
    fputs("    return transmittance;\n}\n", out);
}
