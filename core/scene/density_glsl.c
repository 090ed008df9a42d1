// SPDX-License-Identifier: Apache-2.0
#include "core/scene/density_rules.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/hash_text.h"
#include "core/scene/input_path.h"
#include "core/scene/scene_reader.h"

#include <stdlib.h>
#include <string.h>

static const double LIPSCHITZ_MIN = 1e-9, LIPSCHITZ_MAX = 1e9;
static const double MAJORANT_MIN = 1e-9, MAJORANT_MAX = 1e9;

// The name of a preprocessor directive that `line` begins with and that would affect more than the user's text, or
// NULL.
static const char *find_directive(const char *line)
{
    static const char *const words[] = {"version", "extension", "include", "line"};

    line += strspn(line, " \t\r\v\f");
    if (*line++ != '#') return NULL;
    line += strspn(line, " \t\v\f");
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (strncmp(line, words[i], strlen(words[i])) == 0) return words[i];
    return NULL;
}

static bool fail_directive(const struct json_node *node, const struct scene_glsl *glsl, int line, const char *directive,
                           struct error *error)
{
    if (!glsl->file) return json_fail(node, error, "line %d: #%s is not for densities", line, directive);
    return json_fail(node, error, "%s:%d: #%s is not for densities", scene_glsl_name(glsl), line, directive);
}

static bool check_source(const struct json_node *node, const struct scene_glsl *glsl, const char *source,
                         struct error *error)
{
    size_t size = strlen(source);
    int number = 1;

    if (size == 0 || size > SCENE_GLSL_SIZE_LIMIT)
        return json_fail(node, error, "expected 1 to %d bytes of GLSL, got %zu", SCENE_GLSL_SIZE_LIMIT, size);
    for (const char *line = source; line; number++) {
        const char *directive = find_directive(line), *end = strchr(line, '\n');

        if (directive) return fail_directive(node, glsl, number, directive, error);
        if (number > SCENE_GLSL_LINE_LIMIT)
            return json_fail(node, error, "expected at most %d lines", SCENE_GLSL_LINE_LIMIT);
        line = end ? end + 1 : NULL;
    }
    return true;
}

static bool read_source(const struct scene_reader *reader, struct scene_glsl *glsl)
{
    struct json_node node = json_node_child(reader->object, "source");
    const char *source;

    if (json_node_is_absent(&node))
        return glsl->file || json_fail(reader->object, reader->error, "expected file or source, got none of them");
    if (!json_read_string(&node, &source, reader->error) || !check_source(&node, glsl, source, reader->error))
        return false;
    glsl->source = xstrdup(source);
    return true;
}

static bool read_file(const struct scene_reader *reader, struct scene_glsl *glsl)
{
    struct json_node node = json_node_child(reader->object, "file");
    struct error cause = {0};
    const char *path;

    if (json_node_is_absent(&node)) return true;
    if (!json_read_string(&node, &path, reader->error)) return false;
    if (!input_path_check(path, &cause)) return json_fail(&node, reader->error, "%s", cause.message);
    if (input_path_is_sequence(path)) return json_fail(&node, reader->error, "expected one file, not one a frame");
    glsl->file = xstrdup(path);
    return true;
}

static bool read(struct scene_density *density, const struct scene_reader *reader)
{
    static const char *const keys[] = {"kind", "bounds", "file", "source", "lipschitz", "majorant", "scale", NULL};
    struct json_node bounds = json_node_child(reader->object, "bounds");
    struct json_node lipschitz = json_node_child(reader->object, "lipschitz");
    struct json_node majorant = json_node_child(reader->object, "majorant");
    struct scene_glsl *glsl = &density->glsl;

    if (!json_check_keys(reader->object, keys, reader->error) || !read_file(reader, glsl) || !read_source(reader, glsl))
        return false;
    if (json_node_is_absent(&bounds))
        return json_fail_expected(&bounds, reader->error, "bounds, as the extent of GLSL code is unknown");
    return (json_node_is_absent(&lipschitz) ||
            json_read_number(&lipschitz, LIPSCHITZ_MIN, LIPSCHITZ_MAX, &glsl->lipschitz, reader->error)) &&
           (json_node_is_absent(&majorant) ||
            json_read_number(&majorant, MAJORANT_MIN, MAJORANT_MAX, &glsl->majorant, reader->error)) &&
           scene_reader_read_or(reader, "scale", &SCENE_SCALE, 1.0, &glsl->scale);
}

static void visit_timelines(struct scene_density *density, timeline_visitor *visit, void *user)
{
    visit("scale", &density->glsl.scale, user);
}

static void write_hash_text(const struct scene_density *density, FILE *text)
{
    hash_text_string(text, "source", density->glsl.source);
    hash_text_numbers(text, "lipschitz", &density->glsl.lipschitz, 1);
    if (density->glsl.majorant > 0.0) hash_text_numbers(text, "majorant", &density->glsl.majorant, 1);
}

static void finish(struct scene_density *density)
{
    free(density->glsl.file);
    free(density->glsl.source);
}

// The code depends on the time.
static bool is_sequence(const struct scene_density *density)
{
    (void)density;
    return true;
}

const struct density_rules density_rules_glsl = {
    .name = "glsl",
    .read = read,
    .visit = visit_timelines,
    .write_hash_text = write_hash_text,
    .finish = finish,
    .is_sequence = is_sequence,
};
