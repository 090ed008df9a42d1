// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scatter_similar_glue.h"

#include "core/job/job.h"
#include "worker/model/scatter_grid.h"
#include "worker/model/scene_model.h"
#include "worker/shader/scene_glue_media.h"

// Lobes of a medium without any: one that scatters evenly.
static size_t lobe_count(const struct scene_medium *medium)
{
    return medium->lobe_count > 0 ? medium->lobe_count : 1;
}

static enum lobe_feature lobe_of(const struct scene_model *model, size_t medium, size_t lobe)
{
    return model->job->scene.media[medium].lobe_count > 0 ? model->features.media[medium].lobes[lobe] : LOBE_ISOTROPIC;
}

static bool is_forward(enum lobe_feature lobe)
{
    return lobe == LOBE_HENYEY_GREENSTEIN;
}

// Writes a lobe's weight, in similar media with the share that is left of it.
static void write_weight(FILE *out, const struct scene_model *model, size_t medium, size_t lobe, bool is_similar)
{
    if (model->job->scene.media[medium].lobe_count == 0) {
        fputs("1.0", out);
        return;
    }
    fprintf(out, "medium_%zu_lobe_%zu_weight", medium, lobe);
    if (is_similar && is_forward(lobe_of(model, medium, lobe)))
        fprintf(out, " * similar_share(medium_%zu_lobe_%zu_g)", medium, lobe);
}

static void write_share(FILE *out, const struct scene_model *model, size_t i)
{
    const char *separator = "";

    fprintf(out, "float medium_%zu_similar()\n{\n    return ", i);
    for (size_t k = 0; k < lobe_count(&model->job->scene.media[i]); ++k) {
        if (lobe_of(model, i, k) == LOBE_UNSEEN) continue;
        fputs(separator, out);
        write_weight(out, model, i, k, true);
        separator = " + ";
    }
    fputs(";\n}\n", out);
}

static void write_phase(FILE *out, const struct scene_model *model, size_t i)
{
    const char *separator = "";

    fprintf(out, "float medium_%zu_similar_phase(vec3 incoming, vec3 outgoing)\n{\n    return ", i);
    for (size_t k = 0; k < lobe_count(&model->job->scene.media[i]); ++k) {
        enum lobe_feature lobe = lobe_of(model, i, k);

        if (lobe == LOBE_UNSEEN) continue;
        fputs(separator, out);
        separator = " + ";
        if (is_forward(lobe)) {
            fprintf(out, "medium_%zu_lobe_%zu_weight * similar_phase(medium_%zu_lobe_%zu_g, incoming, outgoing)", i, k,
                    i, k);
            continue;
        }
        write_weight(out, model, i, k, true);
        fputs(lobe == LOBE_RAYLEIGH ? " * phase_rayleigh(dot(incoming, outgoing))" : " * phase_isotropic()", out);
    }
    fputs(";\n}\n", out);
}

static void write_less(FILE *out, enum lobe_feature lobe, size_t medium, size_t index, bool is_similar)
{
    if (is_forward(lobe))
        fprintf(out, "less = %s(medium_%zu_lobe_%zu_g, draw.x);\n",
                is_similar ? "similar_less" : "scatter_henyey_greenstein", medium, index);
    else if (lobe == LOBE_RAYLEIGH)
        fputs("less = scatter_rayleigh(draw.x);\n", out);
    else
        fputs("less = 2.0 * draw.x;\n", out);
}

void scatter_similar_glue_write_turned(FILE *out, const struct scene_model *model, size_t i, bool is_similar)
{
    size_t count = lobe_count(&model->job->scene.media[i]), seen = 0, last = 0;

    for (size_t k = 0; k < count; ++k)
        if (lobe_of(model, i, k) != LOBE_UNSEEN) last = k, seen++;
    fprintf(out, "vec3 medium_%zu%s_turned(vec3 direction, vec2 draw)\n{\n    float less;\n", i,
            is_similar ? "_similar" : "");
    if (seen > 1) fputs("    float lobe = walk_random()", out);
    if (seen > 1 && is_similar) fprintf(out, " * medium_%zu_similar()", i);
    if (seen > 1) fputs(";\n", out);
    for (size_t k = 0; k < last; ++k) {
        if (lobe_of(model, i, k) == LOBE_UNSEEN) continue;
        fputs("    if (lobe < ", out);
        write_weight(out, model, i, k, is_similar);
        fputs(") ", out);
        write_less(out, lobe_of(model, i, k), i, k, is_similar);
        fputs("    else {\n    lobe -= ", out);
        write_weight(out, model, i, k, is_similar);
        fputs(";\n", out);
    }
    fputs("    ", out);
    write_less(out, lobe_of(model, i, last), i, last, is_similar);
    for (size_t k = 1; k < seen; ++k)
        fputs("    }\n", out);
    fputs("    return scatter_turn(direction, less, draw.y);\n}\n", out);
}

// Writes a sum over media of their extinction, less what is not left of their scattering, times `factor`.
static void write_sum(FILE *out, const struct scene_model *model, const char *name, const char *factor)
{
    fprintf(out, "    Spectrum %s = spectrum(0.0);\n", name);
    for (size_t i = 0; i < model->features.medium_count; ++i) {
        const struct medium_features *medium = &model->features.media[i];

        if (!medium_features_have_column(medium)) continue;
        fprintf(out, "    %s += (medium_%zu_sigma_t", name, i);
        if (medium->scatters) fprintf(out, " - (1.0 - medium_%zu_similar()) * medium_%zu_sigma_s", i, i);
        fprintf(out, ") * %s%zu;\n", factor, i);
    }
}

static void write_flights(FILE *out, const struct scene_model *model)
{
    fputs("Spectrum walk_extinction(MediaField field)\n{\n    if (!walk_is_similar) return media_extinction(field);\n",
          out);
    for (size_t i = 0; i < model->features.medium_count; ++i) {
        if (!medium_features_have_column(&model->features.media[i])) continue;
        fprintf(out, "    float density_%zu = ", i);
        scene_glue_write_density(out, model, i);
        fputs(";\n", out);
    }
    write_sum(out, model, "sum", "density_");
    fputs("    return sum;\n}\nSpectrum walk_transmittance(MediaColumn column)\n{\n"
          "    if (!walk_is_cleared) return media_transmittance(column);\n",
          out);
    write_sum(out, model, "depth", "column.medium_");
    fputs("    return exp(-depth);\n}\n"
          // Thinned as little as any medium is, among which each is.
          "float walk_rate_share()\n{\n    float share = 0.0;\n    if (!walk_is_similar) return 1.0;\n",
          out);
    for (size_t i = 0; i < model->features.medium_count; ++i) {
        const struct medium_features *medium = &model->features.media[i];

        if (!medium_features_have_column(medium)) continue;
        if (medium->scatters)
            fprintf(out,
                    "    share = max(share, spectrum_max(1.0 - (1.0 - medium_%zu_similar()) * medium_%zu_sigma_s / "
                    "max(medium_%zu_sigma_t, spectrum(1e-30))));\n",
                    i, i, i);
        else
            fputs("    share = 1.0;\n", out);
    }
    fputs("    return min(share, 1.0);\n}\n", out);
}

void scatter_similar_glue_write(FILE *out, const struct scene_model *model, const struct scatter_grid *grid)
{
    fprintf(out,
            "const int WALK_SIMILAR_AFTER = %d;\n"
            "bool walk_is_similar = false; // flights and scatterings from now on\n"
            "bool walk_is_cleared = false; // light that comes unscattered: it has what is scattered ahead\n",
            scatter_grid_is_similar(grid) ? grid->job->quality.similar_after : 0);
    if (!scatter_grid_is_similar(grid)) {
        fputs("Spectrum walk_extinction(MediaField field)\n{\n    return media_extinction(field);\n}\n"
              "float walk_rate_share()\n{\n    return 1.0;\n}\n",
              out);
        return;
    }
    for (size_t k = 0; k < grid->medium_count; ++k) {
        write_share(out, model, grid->media[k]);
        write_phase(out, model, grid->media[k]);
        scatter_similar_glue_write_turned(out, model, grid->media[k], true);
    }
    write_flights(out, model);
}

void scatter_similar_glue_write_share(FILE *out, const struct scatter_grid *grid, size_t medium)
{
    if (scatter_grid_is_similar(grid)) fprintf(out, " * (walk_is_similar ? medium_%zu_similar() : 1.0)", medium);
}

void scatter_similar_glue_write_turn(FILE *out, const struct scatter_grid *grid, size_t medium, const char *draw)
{
    if (scatter_grid_is_similar(grid))
        fprintf(out, "walk_is_similar ? medium_%zu_similar_turned(direction, %s) : ", medium, draw);
    fprintf(out, "medium_%zu_turned(direction, %s)", medium, draw);
}

void scatter_similar_glue_write_phase(FILE *out, const struct scatter_grid *grid, size_t medium)
{
    if (!scatter_grid_is_similar(grid)) {
        fprintf(out, "medium_%zu_phase(light.direction, direction)", medium);
        return;
    }
    fprintf(out,
            "(walk_is_similar ? medium_%zu_similar_phase(light.direction, direction) : "
            "medium_%zu_phase(light.direction, direction))",
            medium, medium);
}
