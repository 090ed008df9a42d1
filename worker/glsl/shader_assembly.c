// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/shader_assembly.h"

#include "core/base/error.h"
#include "worker/glsl/shader_sources.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

bool shader_assembly_begin(struct shader_assembly *assembly, const char *shader_dir, struct error *error)
{
    *assembly = (struct shader_assembly){
        .shader_dir = shader_dir, .module_names = {"generated"}, .module_count = 1, .error = error};
    assembly->out = open_memstream(&assembly->text, &assembly->length);
    if (!assembly->out) error_set(error, "out of memory");
    return assembly->out != NULL;
}

static void begin_module(struct shader_assembly *assembly, const char *name)
{
    assert(assembly->module_count < SHADER_ASSEMBLY_MODULE_LIMIT);
    fprintf(assembly->out, "#line %zu %zu\n", assembly->module_count * SHADER_ASSEMBLY_LINE_STRIDE + 1,
            assembly->module_count);
    assembly->module_names[assembly->module_count++] = name;
}

void shader_assembly_add(struct shader_assembly *assembly, const char *module)
{
    char *text;
    size_t length;

    for (size_t i = 1; i < assembly->module_count; ++i)
        if (strcmp(assembly->module_names[i], module) == 0) return;
    if (assembly->has_failed) return;
    text = shader_sources_load(assembly->shader_dir, module, assembly->error);
    if (!text) {
        assembly->has_failed = true;
        return;
    }
    begin_module(assembly, module);
    length = strlen(text);
    fprintf(assembly->out, "%s%s", text, length > 0 && text[length - 1] == '\n' ? "" : "\n");
    free(text);
}

void shader_assembly_generate(struct shader_assembly *assembly)
{
    size_t line = 1;

    fflush(assembly->out);
    for (const char *at = assembly->text; (at = strchr(at, '\n')); ++at)
        ++line;
    fprintf(assembly->out, "#line %zu 0\n", line + 1);
}

void shader_assembly_add_text(struct shader_assembly *assembly, const char *name, const char *text)
{
    begin_module(assembly, name);
    fprintf(assembly->out, "%s\n", text);
    shader_assembly_generate(assembly);
}

char *shader_assembly_end(struct shader_assembly *assembly)
{
    char *text;

    fclose(assembly->out);
    text = assembly->text;
    *assembly = (struct shader_assembly){.module_count = assembly->module_count, .has_failed = assembly->has_failed};
    if (!assembly->has_failed) return text;
    free(text);
    return NULL;
}
