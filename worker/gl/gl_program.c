// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/gl_program.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/gl/gl_functions.h"
#include "worker/glsl/shader_assembly.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Reads a position like "3:30012(5)" or "3(30012)" at `text`; returns the text after it, or NULL.
static const char *parse_position(const char *text, unsigned long *line)
{
    char *end;
    char separator;

    if (!isdigit((unsigned char)*text)) return NULL;
    (void)strtoul(text, &end, 10);
    separator = *end;
    if ((separator != ':' && separator != '(') || !isdigit((unsigned char)end[1])) return NULL;
    *line = strtoul(end + 1, &end, 10);
    if (separator == '(') return *end == ')' ? end + 1 : NULL;
    if (*end == '(') {
        end += strcspn(end, ")\n");
        if (*end == ')') ++end;
    }
    return end;
}

// Names that were made private to a medium become what the user wrote.
static void remove_prefixes(char *text)
{
    char *to = text;

    while (*text) {
        int length = 0;

        if (sscanf(text, "medium_%*[0-9]_own_x_%n", &length) == 0 && length > 0)
            text += length - 1; // the name's own underscore stays
        else if (sscanf(text, "medium_%*[0-9]_own_%n", &length) == 0 && length > 0)
            text += length;
        else
            *to++ = *text++;
    }
    *to = 0;
}

char *gl_program_translate_log(const char *log, const char *const *module_names, size_t module_count)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);

    while (stream && *log) {
        size_t length = strcspn(log, "\n") + (strchr(log, '\n') ? 1 : 0);
        const char *start = strncmp(log, "ERROR: ", 7) == 0 ? log + 7 : log;
        unsigned long line = 0;
        const char *rest = parse_position(start, &line);
        unsigned long module = line / SHADER_ASSEMBLY_LINE_STRIDE;

        if (rest && module < module_count) {
            fprintf(stream, "%s:%lu", module_names[module], line % SHADER_ASSEMBLY_LINE_STRIDE);
            fwrite(rest, 1, (size_t)(log + length - rest), stream);
        } else {
            fwrite(log, 1, length, stream);
        }
        log += length;
    }
    if (stream) fclose(stream);
    if (text) remove_prefixes(text);
    return text ? text : xstrdup("");
}

// Sets the first line that is an error rather than a warning, or the first line where none says that it is an error.
static void set_first_error(struct error *error, const char *log)
{
    for (const char *line = log; *line; line += strcspn(line, "\n"), line += *line == '\n') {
        int length = (int)strcspn(line, "\n");

        if (memmem(line, (size_t)length, "error", 5)) {
            error_set(error, "shader: %.*s", length, line);
            return;
        }
    }
    error_set(error, "shader: %.*s", (int)strcspn(log, "\n"), log[0] ? log : "GL gives no reason");
}

static unsigned compile(const struct gl_functions *gl, GLenum stage, const char *source, const char *const *names,
                        size_t name_count, struct error *error)
{
    unsigned shader = gl->CreateShader(stage);
    char log[8192] = "";
    char *translated;
    GLint ok = GL_FALSE;

    gl->ShaderSource(shader, 1, &source, NULL);
    gl->CompileShader(shader);
    gl->GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (ok) return shader;
    gl->GetShaderInfoLog(shader, sizeof log, NULL, log);
    translated = gl_program_translate_log(log, names, name_count);
    log_debug("shader:\n%s", translated);
    set_first_error(error, translated);
    free(translated);
    gl->DeleteShader(shader);
    return 0;
}

// Counts the images that a shader samples, by the declarations in its text.
static int count_samplers(const char *text)
{
    int count = 0;

    for (const char *at = strstr(text, "\nlayout(binding = "); at; at = strstr(at + 1, "\nlayout(binding = ")) {
        const char *sampler = strstr(at, "sampler");

        count += sampler && sampler < at + 1 + strcspn(at + 1, "\n");
    }
    return count;
}

// The driver's message about too many images says neither how many there are nor what they belong to, so this one does.
static void set_link_error(const struct gl_functions *gl, unsigned program, const char *text, struct error *error)
{
    int count = count_samplers(text);
    char log[4096] = "";
    GLint limit = 0;

    gl->GetProgramInfoLog(program, sizeof log, NULL, log);
    log_debug("shader:\n%s", log);
    gl->GetIntegerv(GL_MAX_TEXTURE_IMAGE_UNITS, &limit);
    if (count > limit)
        error_set(error,
                  "scene: its textures and grids are %d images, of which GL here takes %d; expected fewer objects with "
                  "a texture, fewer media with a grid or fewer lights with one",
                  count, limit);
    else
        error_set(error, "shader: does not link: %s", log);
}

unsigned gl_program_create(const struct gl_functions *gl, const struct gl_program_params *params, struct error *error)
{
    static const char *const vertex_name = "fullscreen.vert";
    const char *text = params->compute ? params->compute : params->fragment;
    unsigned vertex = 0, main = 0, program = 0;
    GLint ok = GL_FALSE;

    if (!params->compute) {
        vertex = compile(gl, GL_VERTEX_SHADER, params->vertex, &vertex_name, 1, error);
        if (!vertex) goto out;
    }
    main = compile(gl, params->compute ? GL_COMPUTE_SHADER : GL_FRAGMENT_SHADER, text, params->module_names,
                   params->module_count, error);
    if (!main) goto out;
    program = gl->CreateProgram();
    if (vertex) gl->AttachShader(program, vertex);
    gl->AttachShader(program, main);
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GL_LINK_STATUS, &ok);
    if (!ok) {
        set_link_error(gl, program, text, error);
        gl->DeleteProgram(program);
        program = 0;
    }
out:
    if (vertex) gl->DeleteShader(vertex);
    if (main) gl->DeleteShader(main);
    return program;
}
