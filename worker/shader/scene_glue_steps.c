// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_steps.h"

#include "core/job/job.h"
#include "worker/glsl/gauss_legendre.h"
#include "worker/model/scene_model.h"
#include "worker/shader/scene_glue_media.h"

static void write_extinction(FILE *out, const struct scene_model *model)
{
    const char *separator = "";

    fputs("Spectrum media_extinction(MediaField field)\n{\n    return ", out);
    for (size_t i = 0; i < model->features.medium_count; ++i) {
        if (!medium_features_have_column(&model->features.media[i])) continue;
        fprintf(out, "%smedium_%zu_sigma_t * (", separator, i);
        scene_glue_write_density(out, model, i);
        fputs(")", out);
        separator = " + ";
    }
    fputs(";\n}\n", out);
}

// Writes BEFORE I BETWEEN I for each medium that has a column, with AFTER between them.
static void write_parts(FILE *out, const struct scene_model *model, const char *before, const char *between,
                        const char *after)
{
    const char *separator = "";

    for (size_t i = 0; i < model->features.medium_count; ++i) {
        if (!medium_features_have_column(&model->features.media[i])) continue;
        fprintf(out, "%s%s%zu%s%zu", separator, before, i, between, i);
        separator = after;
    }
}

static void write_columns(FILE *out, const struct scene_model *model)
{
    scene_glue_write_column_none(out, model);
    fputs("void media_column_extend(inout MediaColumn column, MediaColumn rate, float length)\n{\n    ", out);
    write_parts(out, model, "column.medium_", " += length * rate.medium_", ";\n    ");
    fputs(";\n}\nfloat media_column_thickness(MediaColumn column)\n{\n    return spectrum_max(", out);
    write_parts(out, model, "medium_", "_sigma_t * column.medium_", " + ");
    fputs(");\n}\n", out);
}

void scene_glue_write_numbers(FILE *out, const char *name, const double *numbers, int count)
{
    fprintf(out, "const float %s[%d] = float[](", name, count);
    for (int i = 0; i < count; ++i)
        fprintf(out, "%s%.9e", i > 0 ? ", " : "", numbers[i]);
    fputs(");\n", out);
}

static void write_rule(FILE *out, int order)
{
    double nodes[JOB_ORDER_LIMIT], weights[JOB_ORDER_LIMIT], partials[JOB_ORDER_LIMIT * JOB_ORDER_LIMIT];

    gauss_legendre(order, nodes, weights);
    gauss_legendre_partials(order, partials);
    fprintf(out, "const int GAUSS_ORDER = %d;\n", order);
    scene_glue_write_numbers(out, "GAUSS_NODES", nodes, order);
    scene_glue_write_numbers(out, "GAUSS_WEIGHTS", weights, order);
    scene_glue_write_numbers(out, "GAUSS_PARTIALS", partials, order * order);
}

void scene_glue_write_steps(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    if (features->is_gauss) write_rule(out, model->job->quality.order);
    if (!features->is_adaptive) return;
    write_extinction(out, model);
    if (features->marches_to_lights && !features->has_light_grids) write_columns(out, model);
}
