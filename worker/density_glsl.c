#include "core/alloc.h"
#include "core/error.h"
#include "worker/density_kind.h"
#include "worker/glsl_names.h"
#include "worker/timeline_value.h"

#include <stdlib.h>
#include <string.h>

static const char wanted[] = "float density(vec3, float)";

static bool is_zero(const struct scene_density *density)
{
    return timeline_value_is_zero(&density->glsl.scale);
}

static void add_values(struct frame_uniforms *uniforms, const struct density_site *site)
{
    frame_uniforms_add(
        uniforms,
        timeline_value(&site->source->density.glsl.scale, FRAME_VALUE_FLOAT, value_range_not_negative, "density.scale"),
        "medium_%zu_scale", site->medium);
}

static const char *const *modules(const struct density_site *site)
{
    static const char *const names[] = {"density/own.glsl", NULL};

    (void)site;
    return names;
}

// A macro may stand for the function: then the compiler decides.
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

// What the user calls the text of a medium in messages.
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

static void write(FILE *out, const struct density_site *site)
{
    size_t i = site->medium;

    fprintf(out, "DensityOwn medium_%zu_settings()\n{\n    return DensityOwn(medium_%zu_scale, %.9e);\n}\n", i, i,
            site->source->density.glsl.lipschitz);
    fprintf(out, "float medium_%zu_field(vec3 p)\n{\n    return medium_%zu_own_density(p, time_s);\n}\n", i, i);
    fprintf(out, "float medium_%zu_density(float field)\n{\n", i);
    fprintf(out, "    return density_own_at(medium_%zu_settings(), field);\n}\n", i);
    fprintf(out, "float medium_%zu_distance(float field)\n{\n", i);
    fprintf(out, "    return density_own_distance(medium_%zu_settings(), field);\n}\n", i);
}

const struct density_kind density_kind_glsl = {
    .name = "glsl",
    .field_type = "float",
    .takes_time = true,
    .is_zero = is_zero,
    .add_values = add_values,
    .modules = modules,
    .load_text = load_text,
    .write = write,
};
