// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/density/density_bake.h"
#include "worker/density/density_kind.h"
#include "worker/density/scene_bounds.h"
#include "worker/glsl/glsl_names.h"
#include "worker/glsl/glsl_scanner.h"
#include "worker/glsl/scene_anchor.h"
#include "worker/glsl/timeline_value.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char wanted[] = "float density(vec3, float)";

static bool is_zero(const struct scene_density *density)
{
    return timeline_value_is_zero(&density->glsl.scale);
}

static void add_values(struct frame_uniforms *uniforms, const struct density_site *site)
{
    struct density_bake bake;

    frame_uniforms_add(
        uniforms,
        timeline_value(&site->source->density.glsl.scale, FRAME_VALUE_FLOAT, value_range_not_negative, "density.scale"),
        "medium_%zu_scale", site->medium);
    if (!density_bake_find(&bake, site->job, site->medium)) return;
    density_bake_add_values(uniforms, site);
    // Values are means over corners, whose distance from the point averages at most half a cell's diagonal.
    density_bake_add_number(uniforms, site->medium, "reach", 0.5 * sqrt(3) * bake.cell_m);
}

static const char *const *modules(const struct density_site *site)
{
    static const char *const names[] = {"density/own.glsl", NULL};

    (void)site;
    return names;
}

// The function may be hidden in a macro: then the compiler decides.
static bool check_density(const struct glsl_names *names, const char *file, struct error *error)
{
    const struct glsl_name *other = NULL;

    for (size_t i = 0; i < names->count; ++i) {
        const struct glsl_name *name = &names->names[i];

        if (name->is_macro) return true;
        if (strcmp(name->text, "density") != 0) continue;
        if (name->signature && name->has_body && strcmp(name->signature, wanted) == 0) return true;
        if (!other || name->has_body) other = name;
    }
    if (!other)
        error_set(error, "%s: expected a function \"float density(vec3 p, float t)\"", file);
    else if (other->signature && !other->has_body)
        error_set(error, "%s:%d: density: expected the function's body", file, other->line);
    else
        error_set(error, "%s:%d: density: expected \"float density(vec3 p, float t)\", got \"%s\"", file, other->line,
                  other->signature ? other->signature : other->text);
    return false;
}

static char *write_lines(const struct glsl_names *names, const char *prefix)
{
    char *lines = NULL;
    size_t length;
    FILE *out = open_memstream(&lines, &length);

    if (!out) abort();
    if (prefix)
        glsl_names_write_private(names, prefix, out);
    else
        glsl_names_write_hide(names, out);
    fclose(out);
    return lines;
}

// Returns the name of the medium's text for messages.
static const char *text_name(const struct density_site *site)
{
#define MEDIUM(index) "scene.media[" #index "].density.source"
#define INTERIOR(index) "scene.objects[" #index "].material.interior.density.source"
    static const char *const media[SCENE_MEDIUM_LIMIT] = {MEDIUM(0), MEDIUM(1), MEDIUM(2), MEDIUM(3),
                                                          MEDIUM(4), MEDIUM(5), MEDIUM(6), MEDIUM(7)};
    static const char *const interiors[SCENE_OBJECT_LIMIT] = {
        INTERIOR(0), INTERIOR(1), INTERIOR(2),  INTERIOR(3),  INTERIOR(4),  INTERIOR(5),  INTERIOR(6),  INTERIOR(7),
        INTERIOR(8), INTERIOR(9), INTERIOR(10), INTERIOR(11), INTERIOR(12), INTERIOR(13), INTERIOR(14), INTERIOR(15)};
#undef INTERIOR
#undef MEDIUM
    size_t owner = site->source->owner;

    if (site->source->density.glsl.file) return scene_glsl_name(&site->source->density.glsl);
    return owner > 0 ? interiors[owner - 1] : media[site->medium];
}

static bool load_text(const struct density_site *site, struct density_text *text, struct error *error)
{
    static const char *const taken[] = {"Spectrum", NULL}; // macros of our modules
    const struct scene_glsl *glsl = &site->source->density.glsl;
    const char *file = text_name(site);
    struct glsl_names names;
    char *prefix;

    if (!glsl_names_read(&names, file, glsl->source, taken, error)) return false;
    if (!check_density(&names, file, error)) {
        glsl_names_finish(&names);
        return false;
    }
    prefix = xasprintf("medium_%zu_own", site->medium);
    *text = (struct density_text){
        .name = file, .text = glsl->source, .before = write_lines(&names, prefix), .after = write_lines(&names, NULL)};
    free(prefix);
    glsl_names_finish(&names);
    return true;
}

// Reads a parameter list, before which the scanner stands. Returns the name of the second parameter; length 0: it has
// none.
static struct glsl_token read_second_parameter(struct glsl_scanner *scanner)
{
    struct glsl_token token = glsl_scanner_next(scanner), name = {0};
    int words = 0, commas = 0;

    while (token.kind != GLSL_TOKEN_END && !glsl_token_is(&token, ")")) {
        if (glsl_token_is(&token, ",")) {
            commas++;
            words = 0;
        } else if (commas == 1 && token.kind == GLSL_TOKEN_WORD && ++words > 1) {
            name = token; // of "const in float t" as well
        }
        token = glsl_scanner_next(scanner);
    }
    if (name.length == 5 && glsl_token_is(&name, "float")) name.length = 0;
    return name;
}

// Scans the body of a function, if it has one. Returns true when the word is in it.
static bool body_has(struct glsl_scanner *scanner, const struct glsl_token *word)
{
    struct glsl_token token = glsl_scanner_next(scanner);
    bool is_found = false;
    int depth = 0;

    if (!glsl_token_is(&token, "{")) return false;
    for (depth = 1; depth > 0 && token.kind != GLSL_TOKEN_END;) {
        token = glsl_scanner_next(scanner);
        depth += glsl_token_is(&token, "{") - glsl_token_is(&token, "}");
        is_found |=
            word->length > 0 && token.length == word->length && memcmp(token.text, word->text, word->length) == 0;
    }
    return is_found;
}

// Returns false only where the text's density certainly is the same at all times. Macros might hide anything.
static bool uses_time(const struct scene_glsl *glsl)
{
    struct glsl_scanner scanner;
    struct glsl_token token = {0}, before = {0}, type;

    glsl_scanner_init(&scanner, glsl->source);
    do {
        type = before;
        before = token;
        token = glsl_scanner_next(&scanner);
        if (token.kind == GLSL_TOKEN_HASH || token.kind == GLSL_TOKEN_BROKEN || glsl_token_is(&token, "time_s"))
            return true;
        if (glsl_token_is(&token, "(") && glsl_token_is(&before, "density") && glsl_token_is(&type, "float")) {
            struct glsl_token name = read_second_parameter(&scanner);

            if (body_has(&scanner, &name)) return true;
            token = (struct glsl_token){.kind = GLSL_TOKEN_MARK};
        }
    } while (token.kind != GLSL_TOKEN_END);
    return false;
}

static void write(FILE *out, const struct density_site *site)
{
    struct density_bake bake;
    bool is_baked = density_bake_find(&bake, site->job, site->medium);
    size_t i = site->medium;

    fprintf(out, "DensityOwn medium_%zu_settings()\n{\n    return DensityOwn(medium_%zu_scale, %.9e);\n}\n", i, i,
            site->source->density.glsl.lipschitz);
    if (is_baked) {
        density_bake_write_lookup(out, site);
        fprintf(out,
                "float medium_%zu_field(vec3 p)\n{\n    return medium_%zu_baked(p - medium_%zu_bounds_center);\n}\n", i,
                i, i);
    } else {
        fprintf(out, "float medium_%zu_field(vec3 p)\n{\n    return medium_%zu_own_density(p%s, time_s);\n}\n", i, i,
                scene_anchor_is_used(site->job) ? " + scene_anchor" : "");
    }
    fprintf(out, "float medium_%zu_density(float field)\n{\n", i);
    if (job_quality_has_majorants(&site->job->quality))
        fprintf(out, "    return density_own_at(medium_%zu_settings(), majorant_checked(field, %.9e, %zu));\n}\n", i,
                site->source->density.glsl.majorant, i);
    else
        fprintf(out, "    return density_own_at(medium_%zu_settings(), field);\n}\n", i);
    fprintf(out, "float medium_%zu_distance(float field)\n{\n", i);
    if (!is_baked) {
        fprintf(out, "    return density_own_distance(medium_%zu_settings(), field);\n}\n", i);
        return;
    }
    fprintf(out, "    float distance = density_own_distance(medium_%zu_settings(), field);\n", i);
    fprintf(out, "    return distance < 0.0 ? distance : max(distance - medium_%zu_grid_reach, 0.0);\n}\n", i);
}

static void evaluate_majorant(const void *source, double time, double value[static 9])
{
    const struct scene_glsl *glsl = source;

    timeline_value_evaluate(&glsl->scale, time, value);
    value[0] *= glsl->majorant;
}

static void add_majorant(struct frame_uniforms *uniforms, const struct density_site *site)
{
    const struct scene_glsl *glsl = &site->source->density.glsl;

    frame_uniforms_add(uniforms,
                       (struct frame_value){.type = FRAME_VALUE_FLOAT,
                                            .is_constant = timeline_is_constant(&glsl->scale),
                                            .evaluate = evaluate_majorant,
                                            .source = glsl,
                                            .min = value_range_not_negative.min,
                                            .max = value_range_not_negative.max,
                                            .meaning = "density.majorant and scale"},
                       "medium_%zu_majorant", site->medium);
}

static bool find_box(const struct density_site *site, double half_size[static 3])
{
    return density_bake_find_bounds(half_size, site);
}

static void add_baked_values(struct frame_uniforms *uniforms, const struct density_site *site)
{
    const struct scene_density *density = &site->source->density;

    frame_uniforms_add(uniforms, timeline_value_position(&density->bounds.center, "bounds.center"),
                       "medium_%zu_bounds_center", site->medium);
    if (uses_time(&density->glsl)) frame_uniforms_add(uniforms, timeline_value_time(), "time_s");
}

static void write_baked(FILE *out, const struct density_site *site)
{
    size_t i = site->medium;

    fprintf(
        out,
        "float medium_%zu_baked(vec3 p)\n{\n    return medium_%zu_own_density(p + medium_%zu_bounds_center, %s);\n}\n",
        i, i, i, uses_time(&site->source->density.glsl) ? "time_s" : "0.0");
}

const struct density_kind density_kind_glsl = {
    .name = "glsl",
    .field_type = "float",
    .takes_time = true,
    .takes_anchor = true,
    .has_stated_majorant = true,
    .is_zero = is_zero,
    .add_values = add_values,
    .modules = modules,
    .load_text = load_text,
    .write = write,
    .add_majorant = add_majorant,
    .majorant_module = "density/majorant.glsl",
    .find_box = find_box,
    .add_baked_values = add_baked_values,
    .write_baked = write_baked,
};
