// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_media.h"

#include "core/job/job.h"
#include "worker/density/density_kind.h"
#include "worker/density/scene_bounds.h"
#include "worker/model/scene_model.h"

// Chooses the media that a function is about.
typedef bool choose_medium(const struct medium_features *medium);

static bool is_seen(const struct medium_features *medium)
{
    return medium->is_seen;
}

// True where the field is that of a point, not of a segment's ends.
static bool is_pointwise(const struct medium_features *medium)
{
    return medium->is_seen && !medium->is_tabled;
}

static bool is_tabled(const struct medium_features *medium)
{
    return medium->is_tabled;
}

// Returns the first chosen medium from `i` on; medium_count when there is none.
static size_t next(const struct scene_model *model, choose_medium *choose, size_t i)
{
    const struct scene_features *features = &model->features;

    while (i < features->medium_count && !choose(&features->media[i]))
        ++i;
    return i;
}

static bool is_single(const struct scene_model *model, choose_medium *choose)
{
    size_t first = next(model, choose, 0);

    return next(model, choose, first + 1) >= model->features.medium_count;
}

// Runs with `i` as the index of each medium that is chosen.
#define FOR_EACH_MEDIUM(model, choose)                                                                                 \
    for (size_t i = next((model), (choose), 0); i < (model)->features.medium_count; i = next((model), (choose), i + 1))

// True where the integrator may ask for points outside of the medium's span. A single medium is marched through from
// end to end of its span, except by Riemann sums.
static bool needs_test(const struct scene_model *model, choose_medium *choose, size_t i)
{
    const struct scene_density *density = &model->job->scene.media[i].density;
    const struct density_kind *kind = density_kind_of(density);

    if (!is_single(model, choose)) return true;
    if (model->job->quality.method != JOB_METHOD_RIEMANN) return false;
    return density->bounds.kind != SCENE_BOUNDS_NONE || (kind->has_support && !kind->is_zero_outside);
}

static void write_span(FILE *out, const struct scene_density *density, size_t i)
{
    bool has_support = density_kind_of(density)->has_support, has_bounds = density->bounds.kind != SCENE_BOUNDS_NONE;

    fprintf(out, "vec2 medium_%zu_span(vec3 origin, vec3 direction)\n{\n", i);
    if (has_support && has_bounds)
        fprintf(out,
                "    return span_meet(medium_%zu_support(origin, direction), "
                "medium_%zu_bounds_span(origin, direction));\n",
                i, i);
    else if (has_support || has_bounds)
        fprintf(out, "    return medium_%zu_%s(origin, direction);\n", i, has_support ? "support" : "bounds_span");
    else
        fputs("    return SPAN_EVERYWHERE;\n", out);
    fputs("}\n", out);
}

static void write_medium(FILE *out, const struct scene_model *model, size_t i)
{
    const struct scene_medium *medium = &model->job->scene.media[i];
    const struct density_site site = scene_model_site(model, i);

    density_kind_of(&medium->density)->write(out, &site);
    if (medium->density.bounds.kind != SCENE_BOUNDS_NONE)
        scene_bounds_write(out, &medium->density.bounds, model->features.media[i].has_falloff, i);
    write_span(out, &medium->density, i);
}

// "BEFORE_0_AFTER, BEFORE_1_AFTER" over all seen media.
static void write_list(FILE *out, const struct scene_model *model, const char *before, const char *after)
{
    const char *separator = "";

    FOR_EACH_MEDIUM (model, is_seen) {
        fprintf(out, "%s%s%zu%s", separator, before, i, after);
        separator = ", ";
    }
}

static void write_interval(FILE *out, const struct scene_model *model, choose_medium *choose, const char *name)
{
    size_t open = 0;

    fprintf(out, "vec2 %s(MediaSpans spans)\n{\n    return ", name);
    FOR_EACH_MEDIUM (model, choose) {
        bool is_last = next(model, choose, i + 1) >= model->features.medium_count;

        fprintf(out, is_last ? "spans.medium_%zu" : "span_join(spans.medium_%zu, ", i);
        open += !is_last;
    }
    while (open-- > 0)
        fputs(")", out);
    fputs(";\n}\n", out);
}

static void write_next_edge(FILE *out, const struct scene_model *model, choose_medium *choose, const char *name)
{
    fprintf(out, "float %s(MediaSpans spans, float at, float end)\n{\n", name);
    if (!is_single(model, choose)) {
        FOR_EACH_MEDIUM (model, choose)
            fprintf(out, "    end = span_next_edge(spans.medium_%zu, at, end);\n", i);
    }
    fputs("    return end;\n}\n", out);
}

// A bit for each medium that a ray can meet.
static void write_met(FILE *out, const struct scene_model *model)
{
    const char *separator = "";

    fputs("uint media_met(MediaSpans spans)\n{\n    return ", out);
    FOR_EACH_MEDIUM (model, is_seen) {
        fprintf(out, "%s(max(spans.medium_%zu.x, 0.0) < spans.medium_%zu.y ? %uu : 0u)", separator, i, i, 1u << i);
        separator = " | ";
    }
    fputs(";\n}\n", out);
}

static void write_spans(FILE *out, const struct scene_model *model)
{
    fputs("struct MediaSpans {", out);
    FOR_EACH_MEDIUM (model, is_seen)
        fprintf(out, " vec2 medium_%zu;", i);
    fputs(" };\nMediaSpans media_spans(vec3 origin, vec3 direction)\n{\n    return MediaSpans(", out);
    write_list(out, model, "medium_", "_span(origin, direction)");
    fputs(");\n}\nMediaSpans media_spans_from(MediaSpans spans, float start)\n{\n    return MediaSpans(", out);
    write_list(out, model, "spans.medium_", " - start");
    fputs(");\n}\n", out);
    write_met(out, model);
    write_interval(out, model, is_seen, "media_interval");
    write_next_edge(out, model, is_seen, "media_next_edge");
}

static void write_spans_in(FILE *out, const struct scene *scene, const struct scene_model *model)
{
    const char *separator = "";

    fputs("MediaSpans media_spans_in(MediaSpans spans, int region, vec2 piece)\n{\n    return MediaSpans(", out);
    FOR_EACH_MEDIUM (model, is_seen) {
        fprintf(out, "%sregion == %zu ? span_meet(spans.medium_%zu, piece) : SPAN_MISSED", separator,
                scene->media[i].owner, i);
        separator = ",\n        ";
    }
    fputs(");\n}\n", out);
}

static bool has_share(const struct scene_model *model, size_t i)
{
    return model->features.media[i].has_falloff || needs_test(model, is_seen, i);
}

static void write_field_of(FILE *out, const struct density_kind *kind, size_t i)
{
    fprintf(out, "medium_%zu_field(p%s)", i, kind->takes_direction ? ", direction" : "");
}

// Begins the code for points inside of the medium's span; without a test where all points are.
static const char *begin_inside(FILE *out, bool is_tested, size_t i)
{
    if (is_tested) fprintf(out, "    if (span_has(spans.medium_%zu, at)) {\n", i);
    return is_tested ? "        " : "    ";
}

// Writes TARGET = min(TARGET, bound); for the first medium TARGET = bound.
static void write_least(FILE *out, const char *indent, const char *target, bool is_first, const char *bound)
{
    if (is_first)
        fprintf(out, "%s%s = %s;\n", indent, target, bound);
    else
        fprintf(out, "%s%s = min(%s, %s);\n", indent, target, target, bound);
}

static void write_least_outside(FILE *out, const char *target, bool is_first, size_t i)
{
    char bound[96];

    snprintf(bound, sizeof bound, "span_ahead(spans.medium_%zu, at)", i);
    write_least(out, "        ", target, is_first, bound);
    fputs("    }\n", out);
}

static void write_field_part(FILE *out, const struct scene_model *model, size_t i)
{
    const struct density_kind *kind = density_kind_of(&model->job->scene.media[i].density);
    bool is_first = next(model, is_pointwise, 0) == i, is_tested = needs_test(model, is_seen, i);
    const char *indent = begin_inside(out, is_tested, i);
    char bound[96];

    fprintf(out, "%sfield.medium_%zu = ", indent, i);
    write_field_of(out, kind, i);
    fputs(";\n", out);
    if (model->features.media[i].has_falloff)
        fprintf(out, "%sfield.medium_%zu_share = medium_%zu_falloff(p);\n", indent, i, i);
    else if (is_tested)
        fprintf(out, "%sfield.medium_%zu_share = 1.0;\n", indent, i);
    snprintf(bound, sizeof bound, "medium_%zu_distance(field.medium_%zu)", i, i);
    write_least(out, indent, "field.distance", is_first, bound);
    if (!is_tested) return;
    fprintf(out, "    } else {\n        field.medium_%zu = %s(0.0);\n        field.medium_%zu_share = 0.0;\n", i,
            kind->field_type, i);
    write_least_outside(out, "field.distance", is_first, i);
}

static const char *field_type(const struct scene_model *model, size_t i)
{
    return model->features.media[i].is_tabled ? "vec4"
                                              : density_kind_of(&model->job->scene.media[i].density)->field_type;
}

// Values of a medium with a table are set later, from a segment's ends. The field says only whether there are any, and
// the falloff.
static void write_tabled_part(FILE *out, const struct scene_model *model, size_t i)
{
    bool is_tested = needs_test(model, is_seen, i);

    fprintf(out, "    field.medium_%zu = vec4(0.0);\n", i);
    if (!has_share(model, i)) return;
    fprintf(out, "    field.medium_%zu_share = ", i);
    if (is_tested) fprintf(out, "!span_has(spans.medium_%zu, at) ? 0.0 : ", i);
    if (model->features.media[i].has_falloff)
        fprintf(out, "medium_%zu_falloff(p);\n", i);
    else
        fputs("1.0;\n", out);
}

static void write_clear(FILE *out, const struct scene_model *model)
{
    bool is_first = true;

    fputs("// How far along the ray the media that have tables are empty.\n"
          "float media_clear(MediaSpans spans, vec3 p, vec3 direction, float at)\n{\n    float clear;\n",
          out);
    FOR_EACH_MEDIUM (model, is_tabled) {
        bool is_tested = needs_test(model, is_seen, i);
        const char *indent = begin_inside(out, is_tested, i);
        char bound[96];

        snprintf(bound, sizeof bound, "medium_%zu_clear(p, direction)", i);
        write_least(out, indent, "clear", is_first, bound);
        if (is_tested) {
            fputs("    } else {\n", out);
            write_least_outside(out, "clear", is_first, i);
        }
        is_first = false;
    }
    fputs("    return clear;\n}\n", out);
}

// Writes a function that returns all members of a MediaEnds. # in `format` is the medium's index.
static void write_ends(FILE *out, const struct scene_model *model, const char *declaration, const char *format)
{
    const char *separator = "";

    fprintf(out, "MediaEnds %s\n{\n    return MediaEnds(", declaration);
    FOR_EACH_MEDIUM (model, is_tabled) {
        fputs(separator, out);
        for (const char *at = format; *at; ++at)
            if (*at == '#')
                fprintf(out, "%zu", i);
            else
                fputc(*at, out);
        separator = ", ";
    }
    fputs(");\n}\n", out);
}

static void write_tables(FILE *out, const struct scene_model *model)
{
    const char *separator = "";
    bool is_alone = next(model, is_pointwise, 0) >= model->features.medium_count;

    fprintf(out, "const float MEDIA_CLEAR_END = %s;\nconst bool MEDIA_ARE_LIT = %s;\n", is_alone ? "FAR_AWAY" : "0.0",
            model->features.media_are_lit ? "true" : "false");
    fputs("struct MediaEnds {", out);
    FOR_EACH_MEDIUM (model, is_tabled)
        fprintf(out, " TransferEnd medium_%zu;", i);
    fputs(" };\n", out);
    write_ends(out, model, "media_ends(vec3 p)", "medium_#_end(p)");
    write_ends(out, model, "media_ends_between(MediaEnds from, MediaEnds to, float share)",
               "medium_#_end_at(mix(from.medium_#.position, to.medium_#.position, share))");
    fputs("void media_set_slopes(inout MediaEnds to, MediaEnds from, float length)\n{\n", out);
    FOR_EACH_MEDIUM (model, is_tabled)
        fprintf(out, "    to.medium_%zu.slope = (to.medium_%zu.position - from.medium_%zu.position) / length;\n", i, i,
                i);
    fputs("}\nvoid media_set_means(inout MediaField field, MediaEnds from, MediaEnds to, float bend)\n{\n", out);
    FOR_EACH_MEDIUM (model, is_tabled)
        fprintf(out, "    field.medium_%zu = transfer_mean(from.medium_%zu, to.medium_%zu, bend);\n", i, i, i);
    fputs("}\n// Optical depth of the media that have tables, per metre.\nfloat media_depth(MediaField field)\n{\n    "
          "return ",
          out);
    FOR_EACH_MEDIUM (model, is_tabled) {
        fputs(separator, out);
        scene_glue_write_density(out, model, i);
        separator = " + ";
    }
    fputs(";\n}\n", out);
    write_clear(out, model);
}

static void write_field(FILE *out, const struct scene_model *model)
{
    fputs("struct MediaField {", out);
    FOR_EACH_MEDIUM (model, is_seen) {
        fprintf(out, " %s medium_%zu;", field_type(model, i), i);
        if (has_share(model, i)) fprintf(out, " float medium_%zu_share;", i);
    }
    fputs(" float distance; };\nMediaField media_field(MediaSpans spans, vec3 p, vec3 direction, float at)\n{\n"
          "    MediaField field;\n",
          out);
    if (next(model, is_pointwise, 0) >= model->features.medium_count) fputs("    field.distance = FAR_AWAY;\n", out);
    FOR_EACH_MEDIUM (model, is_seen) {
        if (model->features.media[i].is_tabled)
            write_tabled_part(out, model, i);
        else
            write_field_part(out, model, i);
    }
    fputs("    return field;\n}\n", out);
}

void scene_glue_write_density(FILE *out, const struct scene_model *model, size_t i)
{
    if (has_share(model, i)) fprintf(out, "field.medium_%zu_share * ", i);
    fprintf(out, "medium_%zu_density(field.medium_%zu)", i, i);
}

static void write_column_sum(FILE *out, const struct scene_model *model, const char *before, const char *after)
{
    const char *separator = "";

    FOR_EACH_MEDIUM (model, medium_features_have_column) {
        fprintf(out, "%s%smedium_%zu_sigma_t%s * column.medium_%zu", separator, before, i, after, i);
        separator = " + ";
    }
}

static void write_column_part(FILE *out, const struct scene_model *model, size_t i)
{
    const struct density_kind *kind = density_kind_of(&model->job->scene.media[i].density);
    bool is_first = next(model, medium_features_march_to_lights, 0) == i;
    bool is_tested = needs_test(model, medium_features_march_to_lights, i);
    const char *indent = begin_inside(out, is_tested, i);
    char bound[96];

    fprintf(out, "%s%s field_%zu = ", indent, kind->field_type, i);
    write_field_of(out, kind, i);
    fprintf(out, ";\n%scolumn.medium_%zu += length * ", indent, i);
    if (model->features.media[i].has_falloff) fprintf(out, "medium_%zu_falloff(p) * ", i);
    fprintf(out, "medium_%zu_density(field_%zu);\n", i, i);
    snprintf(bound, sizeof bound, "medium_%zu_distance(field_%zu)", i, i);
    write_least(out, indent, "empty", is_first, bound);
    if (!is_tested) return;
    fputs("    } else {\n", out);
    write_least_outside(out, "empty", is_first, i);
}

static void write_column_march(FILE *out, const struct scene_model *model)
{
    write_interval(out, model, medium_features_march_to_lights, "media_column_interval");
    write_next_edge(out, model, medium_features_march_to_lights, "media_column_next_edge");
    fputs("float media_column_add(inout MediaColumn column, MediaSpans spans, vec3 p, vec3 direction, float at, "
          "float length)\n{\n    float empty;\n",
          out);
    FOR_EACH_MEDIUM (model, medium_features_march_to_lights)
        write_column_part(out, model, i);
    fputs("    return empty;\n}\n", out);
}

static void write_column_depth(FILE *out, const struct scene_model *model)
{
    fputs("float media_column_depth(MediaColumn column)\n{\n    return ", out);
    write_column_sum(out, model, "spectrum_min(", ")");
    fputs(";\n}\n", out);
}

static void write_column(FILE *out, const struct scene_model *model)
{
    const char *separator = "";

    fputs("// Density integrated along a ray, a number a medium.\nstruct MediaColumn {", out);
    FOR_EACH_MEDIUM (model, medium_features_have_column)
        fprintf(out, " float medium_%zu;", i);
    fputs(" };\nMediaColumn media_column_begin(MediaSpans spans, float distance)\n{\n    return MediaColumn(", out);
    FOR_EACH_MEDIUM (model, medium_features_have_column) {
        fputs(separator, out);
        separator = ", ";
        if (model->features.media[i].is_even)
            fprintf(out, "span_length(spans.medium_%zu, distance) * medium_%zu_density(%s(0.0))", i, i,
                    density_kind_of(&model->job->scene.media[i].density)->field_type);
        else
            fputs("0.0", out);
    }
    fputs(");\n}\n", out);
}

static void write_transmittance(FILE *out, const struct scene_model *model)
{
    fputs("Spectrum media_transmittance(MediaColumn column)\n{\n    return exp(-(", out);
    write_column_sum(out, model, "", "");
    fputs("));\n}\n", out);
}

void scene_glue_write_media(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    FOR_EACH_MEDIUM (model, is_seen)
        write_medium(out, model, i);
    write_spans(out, model);
    if (features->has_objects) write_spans_in(out, &model->job->scene, model);
    write_field(out, model);
    if (features->is_tabled) write_tables(out, model);
    if ((!features->has_lights && !features->is_tracked) || !features->has_extinction) return;
    write_column(out, model);
    write_transmittance(out, model);
    if (!features->marches_to_lights && !features->estimates_columns) return;
    if (features->has_light_grids) return;
    write_column_march(out, model);
    if (!features->is_tracked) write_column_depth(out, model);
}

void scene_glue_write_column_none(FILE *out, const struct scene_model *model)
{
    const char *separator = "";

    fputs("MediaColumn media_column_none()\n{\n    return MediaColumn(", out);
    FOR_EACH_MEDIUM (model, medium_features_have_column) {
        fprintf(out, "%s0.0", separator);
        separator = ", ";
    }
    fputs(");\n}\n", out);
}

void scene_glue_write_columns(FILE *out, const struct scene_model *model)
{
    FOR_EACH_MEDIUM (model, is_seen)
        write_medium(out, model, i);
    write_spans(out, model);
    write_column(out, model);
    write_column_march(out, model);
}
