// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/gl_context_backend.h"

#include "core/base/alloc.h"

#include <GL/glcorearb.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Names from GL_EXT_memory_object, which the core header lacks.
enum { DEVICE_UUID = 0x9597, UUID_SIZE = 16 };
typedef void(APIENTRY *get_unsigned_bytes_function)(GLenum name, GLuint index, GLubyte *bytes);

void gl_context_trials_add(struct gl_context_trials *trials, const char *format, ...)
{
    va_list arguments;
    char clause[512];
    char *text;

    va_start(arguments, format);
    vsnprintf(clause, sizeof clause, format, arguments);
    va_end(arguments);
    text = trials->text ? xasprintf("%s; %s", trials->text, clause) : xstrdup(clause);
    free(trials->text);
    trials->text = text;
}

void gl_context_format_uuid(const unsigned char bytes[static 16], char text[static 40])
{
    size_t length = 0;

    for (int i = 0; i < UUID_SIZE; ++i) {
        bool dash = i == 4 || i == 6 || i == 8 || i == 10;

        length += (size_t)snprintf(text + length, 40 - length, dash ? "-%02x" : "%02x", bytes[i]);
    }
}

static bool has_extension(const struct gl_context *context, const char *wanted)
{
    PFNGLGETINTEGERVPROC get_integer = (PFNGLGETINTEGERVPROC)context->function(context, "glGetIntegerv");
    PFNGLGETSTRINGIPROC get_string = (PFNGLGETSTRINGIPROC)context->function(context, "glGetStringi");
    GLint count = 0;

    if (!get_integer || !get_string) return false;
    get_integer(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; ++i) {
        const GLubyte *name = get_string(GL_EXTENSIONS, (GLuint)i);

        if (name && strcmp((const char *)name, wanted) == 0) return true;
    }
    return false;
}

static void read_device_uuid(struct gl_context *context)
{
    static const unsigned char unknown[UUID_SIZE];
    get_unsigned_bytes_function get_bytes =
        (get_unsigned_bytes_function)context->function(context, "glGetUnsignedBytei_vEXT");
    unsigned char uuid[UUID_SIZE] = {0};

    if (context->facts.device_uuid[0] || !get_bytes || !has_extension(context, "GL_EXT_memory_object")) return;
    get_bytes(DEVICE_UUID, 0, uuid);
    if (memcmp(uuid, unknown, sizeof uuid) != 0) gl_context_format_uuid(uuid, context->facts.device_uuid);
}

static void copy_string(const struct gl_context *context, GLenum name, char *text, size_t size)
{
    PFNGLGETSTRINGPROC get_string = (PFNGLGETSTRINGPROC)context->function(context, "glGetString");
    const GLubyte *value = get_string ? get_string(name) : NULL;

    snprintf(text, size, "%s", value ? (const char *)value : "");
}

bool gl_context_read_facts(struct gl_context *context, struct gl_context_trials *trials)
{
    struct gl_context_facts *facts = &context->facts;
    int major = 0, minor = 0;

    copy_string(context, GL_VENDOR, facts->vendor, sizeof facts->vendor);
    copy_string(context, GL_RENDERER, facts->renderer, sizeof facts->renderer);
    copy_string(context, GL_VERSION, facts->version, sizeof facts->version);
    if (sscanf(facts->version, "%d.%d", &major, &minor) != 2 || major * 10 + minor < 45) {
        gl_context_trials_add(trials, "%s: expected OpenGL 4.5, got \"%s\" (%s)", facts->backend, facts->version,
                              facts->renderer);
        return false;
    }
    facts->is_software = strstr(facts->renderer, "llvmpipe") || strstr(facts->renderer, "softpipe") ||
                         strstr(facts->renderer, "swrast") || strstr(facts->renderer, "Software");
    read_device_uuid(context);
    return true;
}
