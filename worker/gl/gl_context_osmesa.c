// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "worker/gl/gl_context_backend.h"

#include <GL/glcorearb.h>
#include <dlfcn.h>
#include <stdlib.h>

// Values of GL/osmesa.h, a header that Mesa has only up to 25.0.
enum {
    OSMESA_FORMAT = 0x22,
    OSMESA_PROFILE = 0x33,
    OSMESA_CORE_PROFILE = 0x34,
    OSMESA_CONTEXT_MAJOR_VERSION = 0x36,
    OSMESA_CONTEXT_MINOR_VERSION = 0x37
};

enum { BUFFER_SIDE_PX = 16 };

struct osmesa_context {
    struct gl_context base; // first: the base is this struct's address
    void *handle;           // owned
    void (*destroy)(void *handle);
    gl_function *(*function)(const char *name);
    unsigned char buffer[BUFFER_SIDE_PX * BUFFER_SIDE_PX * 4]; // GL's default framebuffer; nothing is drawn there
};

static gl_function *find_function(const struct gl_context *context, const char *name)
{
    const struct osmesa_context *osmesa = (const struct osmesa_context *)context;

    return osmesa->function(name);
}

static void destroy(struct gl_context *context)
{
    struct osmesa_context *osmesa = (struct osmesa_context *)context;

    if (osmesa->destroy && osmesa->handle) osmesa->destroy(osmesa->handle);
    free(osmesa);
}

// The library stays loaded for the life of the process: Mesa's threads and LLVM do not survive being unloaded.
static void *load_library(struct gl_context_trials *trials)
{
    static const char *const names[] = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
    void *library = NULL;

    for (size_t i = 0; !library && i < sizeof names / sizeof *names; ++i)
        library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL);
    if (!library) gl_context_trials_add(trials, "osmesa: no libOSMesa.so.8 or .so.6 here");
    return library;
}

struct gl_context *gl_context_osmesa_create(const char *device, struct gl_context_trials *trials)
{
    static const int attributes[] = {OSMESA_FORMAT,
                                     GL_RGBA,
                                     OSMESA_PROFILE,
                                     OSMESA_CORE_PROFILE,
                                     OSMESA_CONTEXT_MAJOR_VERSION,
                                     4,
                                     OSMESA_CONTEXT_MINOR_VERSION,
                                     5,
                                     0};
    void *(*create)(const int *, void *);
    GLboolean (*make_current)(void *, void *, GLenum, GLsizei, GLsizei);
    struct osmesa_context *osmesa = NULL;
    void *library;

    if (device) {
        gl_context_trials_add(trials, "osmesa: expected no device, got \"%s\"", device);
        return NULL;
    }
    library = load_library(trials);
    if (!library) return NULL;
    osmesa = xcalloc(1, sizeof *osmesa);
    osmesa->base = (struct gl_context){.function = find_function, .destroy = destroy, .facts.backend = "osmesa"};
    *(void **)&create = dlsym(library, "OSMesaCreateContextAttribs");
    *(void **)&make_current = dlsym(library, "OSMesaMakeCurrent");
    *(void **)&osmesa->destroy = dlsym(library, "OSMesaDestroyContext");
    *(void **)&osmesa->function = dlsym(library, "OSMesaGetProcAddress");
    if (!create || !make_current || !osmesa->destroy || !osmesa->function) {
        gl_context_trials_add(trials, "osmesa: the library lacks OSMesaCreateContextAttribs");
        goto failed;
    }
    osmesa->handle = create(attributes, NULL);
    if (!osmesa->handle) {
        gl_context_trials_add(trials, "osmesa: no OpenGL 4.5 core context");
        goto failed;
    }
    if (!make_current(osmesa->handle, osmesa->buffer, GL_UNSIGNED_BYTE, BUFFER_SIDE_PX, BUFFER_SIDE_PX)) {
        gl_context_trials_add(trials, "osmesa: the context does not become current");
        goto failed;
    }
    if (gl_context_read_facts(&osmesa->base, trials)) return &osmesa->base;
failed:
    destroy(&osmesa->base);
    return NULL;
}
