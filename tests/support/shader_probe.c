// SPDX-License-Identifier: Apache-2.0
#include "tests/support/shader_probe.h"

#include "core/base/error.h"
#include "tests/support/keep_libraries.h"
#include "tests/support/shader_dir.h"
#include "worker/gl/gl_context.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/gl_program.h"
#include "worker/glsl/shader_sources.h"
#include "worker/picture/image.h"
#include "worker/render/gl_target.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MODULE_LIMIT = 16 };

// Names for the compiler's messages go to `names`: 0 is what this file and the test write.
static char *assemble(const struct shader_probe_params *params, const char *names[MODULE_LIMIT], size_t *name_count,
                      struct error *error)
{
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);

    *name_count = 0;
    names[(*name_count)++] = "probe";
    fprintf(out, "#version 450 core\n%s", params->head ? params->head : "");
    for (size_t i = 0; params->modules[i]; i++) {
        char *module = shader_sources_load(test_shader_dir(), params->modules[i], error);

        if (!module || *name_count == MODULE_LIMIT) fail_msg("%s: %s", params->modules[i], error->message);
        fprintf(out, "#line 1 %zu\n%s\n", *name_count, module);
        names[(*name_count)++] = params->modules[i];
        free(module);
    }
    fprintf(out,
            "layout(std140, binding = 0) uniform Inputs { vec4 inputs[%d]; };\n#line 1 0\n%s\n"
            "layout(location = 0) out vec4 result;\n"
            "void main()\n{\n    result = probe(int(gl_FragCoord.x));\n}\n",
            SHADER_PROBE_INPUT_LIMIT, params->body);
    fclose(out);
    return text;
}

static void draw(const struct gl_functions *gl, unsigned program, const struct shader_probe_params *params,
                 struct image *image)
{
    struct error error = {{0}};
    struct gl_target target = {0};
    unsigned vertex_array, buffer;
    float block[SHADER_PROBE_INPUT_LIMIT][4] = {{0}};

    memcpy(block, params->inputs, params->input_count * sizeof block[0]);
    gl->CreateVertexArrays(1, &vertex_array);
    gl->CreateBuffers(1, &buffer);
    gl->NamedBufferData(buffer, sizeof block, block, GL_STREAM_DRAW);
    gl->BindBufferBase(GL_UNIFORM_BUFFER, 0, buffer);
    if (!gl_target_init(&target, gl, &(struct gl_target_params){.image = image, .pass_count = 1}, &error))
        fail_msg("%s", error.message);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, target.framebuffer);
    gl->Viewport(0, 0, image->width_px, image->height_px);
    gl->BindVertexArray(vertex_array);
    gl->UseProgram(program);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    gl_target_read(&target, NULL, image, NULL);
    assert_int_equal(gl->GetError(), GL_NO_ERROR);
    gl_target_finish(&target);
    gl->DeleteBuffers(1, &buffer);
    gl->DeleteVertexArrays(1, &vertex_array);
}

void shader_probe_run(const struct shader_probe_params *params, float (*outputs)[4])
{
    struct error error = {{0}};
    struct gl_context *context = gl_context_create(params->on_egl ? GL_BACKEND_EGL : GL_BACKEND_SOFTWARE, NULL, &error);
    const char *names[MODULE_LIMIT];
    size_t name_count;
    char *vertex, *fragment;
    struct gl_functions gl;
    struct image image;
    unsigned program;

    if (!context) fail_msg("%s", error.message);
    keep_libraries();
    assert_true(params->input_count <= SHADER_PROBE_INPUT_LIMIT);
    if (!gl_functions_load(&gl, context, &error)) fail_msg("%s", error.message);
    vertex = shader_sources_load(test_shader_dir(), "fullscreen.vert", &error);
    fragment = assemble(params, names, &name_count, &error);
    program = gl_program_create(
        &gl,
        &(struct gl_program_params){
            .vertex = vertex, .fragment = fragment, .module_names = names, .module_count = name_count},
        &error);
    if (!program) fail_msg("%s", error.message);
    assert_true(image_init(&image, (int)params->count, 1, false, false, &error));
    if (params->bind) params->bind(&gl, params->user);
    draw(&gl, program, params, &image);
    if (params->release) params->release(params->user);
    memcpy(outputs, image.rgba, params->count * sizeof outputs[0]);
    gl.DeleteProgram(program);
    image_finish(&image);
    free(vertex);
    free(fragment);
    gl_context_destroy(context);
}
