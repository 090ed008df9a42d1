// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "worker/gl/gl_context_backend.h"
#include "worker/gl/gl_device.h"

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <ctype.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { DEVICE_LIMIT = 64, UUID_SIZE = 16 };

struct egl_library {
    PFNEGLGETPROCADDRESSPROC get_proc_address;
    PFNEGLQUERYSTRINGPROC query_string;
    PFNEGLGETERRORPROC get_error;
    PFNEGLINITIALIZEPROC initialize;
    PFNEGLBINDAPIPROC bind_api;
    PFNEGLCREATECONTEXTPROC create_context;
    PFNEGLDESTROYCONTEXTPROC destroy_context;
    PFNEGLMAKECURRENTPROC make_current;
    PFNEGLRELEASETHREADPROC release_thread;
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display;
    PFNEGLQUERYDEVICESEXTPROC query_devices;               // NULL without device enumeration
    PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string;    // NULL without device enumeration
    PFNEGLQUERYDEVICEATTRIBEXTPROC query_device_attribute; // NULL without device enumeration
    PFNEGLQUERYDEVICEBINARYEXTPROC query_device_binary;    // NULL without EGL_EXT_device_persistent_id
};

struct egl_context {
    struct gl_context base; // first: the base is this struct's address
    struct egl_library egl;
    EGLDisplay display; // EGL owns it; it stays initialised, for drivers do not survive being unloaded
    EGLContext handle;  // owned
};

// A display that a context can be made on, and its name in messages.
struct egl_target {
    EGLenum platform;
    void *native; // an EGLDeviceEXT, or EGL_DEFAULT_DISPLAY
    char name[48];
    char uuid[40]; // empty when EGL does not report it
};

static bool has_word(const char *words, const char *wanted)
{
    size_t length = strlen(wanted);

    for (const char *at = words; at && (at = strstr(at, wanted)); at += length)
        if ((at == words || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0')) return true;
    return false;
}

// The library stays loaded for the life of the process: drivers do not survive being unloaded.
static bool load_library(struct egl_library *egl, struct gl_context_trials *trials)
{
    void *library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    const char *extensions;

    if (!library) {
        gl_context_trials_add(trials, "egl: no libEGL.so.1 here");
        return false;
    }
    *(void **)&egl->get_proc_address = dlsym(library, "eglGetProcAddress");
    *(void **)&egl->query_string = dlsym(library, "eglQueryString");
    *(void **)&egl->get_error = dlsym(library, "eglGetError");
    *(void **)&egl->initialize = dlsym(library, "eglInitialize");
    *(void **)&egl->bind_api = dlsym(library, "eglBindAPI");
    *(void **)&egl->create_context = dlsym(library, "eglCreateContext");
    *(void **)&egl->destroy_context = dlsym(library, "eglDestroyContext");
    *(void **)&egl->make_current = dlsym(library, "eglMakeCurrent");
    *(void **)&egl->release_thread = dlsym(library, "eglReleaseThread");
    if (!egl->get_proc_address || !egl->query_string || !egl->get_error || !egl->initialize || !egl->bind_api ||
        !egl->create_context || !egl->destroy_context || !egl->make_current || !egl->release_thread) {
        gl_context_trials_add(trials, "egl: libEGL.so.1 is not whole");
        return false;
    }
    egl->get_platform_display = (PFNEGLGETPLATFORMDISPLAYEXTPROC)egl->get_proc_address("eglGetPlatformDisplayEXT");
    extensions = egl->query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!has_word(extensions, "EGL_EXT_platform_base") || !egl->get_platform_display) {
        gl_context_trials_add(trials, "egl: EGL_EXT_platform_base is missing");
        return false;
    }
    if (has_word(extensions, "EGL_EXT_device_base") ||
        (has_word(extensions, "EGL_EXT_device_enumeration") && has_word(extensions, "EGL_EXT_device_query"))) {
        egl->query_devices = (PFNEGLQUERYDEVICESEXTPROC)egl->get_proc_address("eglQueryDevicesEXT");
        egl->query_device_attribute = (PFNEGLQUERYDEVICEATTRIBEXTPROC)egl->get_proc_address("eglQueryDeviceAttribEXT");
        egl->query_device_string = (PFNEGLQUERYDEVICESTRINGEXTPROC)egl->get_proc_address("eglQueryDeviceStringEXT");
        egl->query_device_binary = (PFNEGLQUERYDEVICEBINARYEXTPROC)egl->get_proc_address("eglQueryDeviceBinaryEXT");
    }
    return true;
}

static gl_function *find_function(const struct gl_context *context, const char *name)
{
    return (gl_function *)((const struct egl_context *)context)->egl.get_proc_address(name);
}

static void destroy(struct gl_context *context)
{
    struct egl_context *made = (struct egl_context *)context;

    if (made->display != EGL_NO_DISPLAY) {
        made->egl.make_current(made->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (made->handle != EGL_NO_CONTEXT) made->egl.destroy_context(made->display, made->handle);
        made->egl.release_thread();
    }
    free(made);
}

// Prefers a context that reports its loss and falls back to one that does not.
static EGLContext create_handle(const struct egl_library *egl, EGLDisplay display)
{
    static const EGLint robust[] = {EGL_CONTEXT_MAJOR_VERSION,
                                    4,
                                    EGL_CONTEXT_MINOR_VERSION,
                                    5,
                                    EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                    EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                    EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                    EGL_LOSE_CONTEXT_ON_RESET,
                                    EGL_NONE};
    static const EGLint plain[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLContext handle = egl->create_context(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, robust);

    return handle ? handle : egl->create_context(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, plain);
}

static bool open_display(struct egl_context *context, const struct egl_target *target, struct gl_context_trials *trials)
{
    const struct egl_library *egl = &context->egl;
    EGLDisplay display = egl->get_platform_display(target->platform, target->native, NULL);
    const char *extensions;
    EGLint major, minor;

    if (display == EGL_NO_DISPLAY || !egl->initialize(display, &major, &minor)) {
        gl_context_trials_add(trials, "%s: no display (EGL error 0x%x)", target->name, (unsigned)egl->get_error());
        return false;
    }
    context->display = display;
    extensions = egl->query_string(display, EGL_EXTENSIONS);
    if (!has_word(extensions, "EGL_KHR_surfaceless_context") || !has_word(extensions, "EGL_KHR_no_config_context")) {
        gl_context_trials_add(trials, "%s: lacks EGL_KHR_surfaceless_context or EGL_KHR_no_config_context",
                              target->name);
        return false;
    }
    return true;
}

static struct gl_context *create_at(const struct egl_library *egl, const struct egl_target *target,
                                    struct gl_context_trials *trials)
{
    struct egl_context *context = xcalloc(1, sizeof *context);

    context->base = (struct gl_context){.function = find_function, .destroy = destroy, .facts.backend = "egl"};
    memcpy(context->base.facts.device_uuid, target->uuid, sizeof target->uuid);
    context->egl = *egl;
    context->display = EGL_NO_DISPLAY;
    context->handle = EGL_NO_CONTEXT;
    if (!open_display(context, target, trials)) goto failed;
    if (egl->bind_api(EGL_OPENGL_API)) context->handle = create_handle(egl, context->display);
    if (context->handle == EGL_NO_CONTEXT) {
        gl_context_trials_add(trials, "%s: no OpenGL 4.5 core context (EGL error 0x%x)", target->name,
                              (unsigned)egl->get_error());
        goto failed;
    }
    if (!egl->make_current(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context->handle)) {
        gl_context_trials_add(trials, "%s: the context does not become current (EGL error 0x%x)", target->name,
                              (unsigned)egl->get_error());
        goto failed;
    }
    if (gl_context_read_facts(&context->base, trials)) return &context->base;
failed:
    destroy(&context->base);
    return NULL;
}

static struct egl_target device_target(const struct egl_library *egl, EGLDeviceEXT device, int index)
{
    struct egl_target target = {.platform = EGL_PLATFORM_DEVICE_EXT, .native = device};
    const char *extensions = egl->query_device_string(device, EGL_EXTENSIONS);
    unsigned char uuid[UUID_SIZE];
    EGLint size = 0;

    snprintf(target.name, sizeof target.name, "egl device %d", index);
    if (egl->query_device_binary && has_word(extensions, "EGL_EXT_device_persistent_id") &&
        egl->query_device_binary(device, EGL_DEVICE_UUID_EXT, UUID_SIZE, uuid, &size) && size == UUID_SIZE)
        gl_context_format_uuid(uuid, target.uuid);
    return target;
}

static bool is_index(const char *device)
{
    return device[0] && strlen(device) < 4 && strspn(device, "0123456789") == strlen(device);
}

// Compares without regard to case and to the "GPU-" that NVIDIA's tools put before a UUID.
static bool is_uuid_equal(const char *wanted, const char *uuid)
{
    if (strncasecmp(wanted, "GPU-", 4) == 0) wanted += 4;
    return strcasecmp(wanted, uuid) == 0;
}

static struct gl_context *create_on_device(const struct egl_library *egl, EGLDeviceEXT device, int index,
                                           const char *wanted, struct gl_context_trials *trials)
{
    struct egl_target target = device_target(egl, device, index);
    struct gl_context *context;

    if (wanted && is_index(wanted) && atoi(wanted) != index) return NULL;
    if (wanted && !is_index(wanted) && target.uuid[0] && !is_uuid_equal(wanted, target.uuid)) {
        gl_context_trials_add(trials, "%s: is %s", target.name, target.uuid);
        return NULL;
    }
    context = create_at(egl, &target, trials);
    if (context && wanted && !is_index(wanted) && !is_uuid_equal(wanted, context->facts.device_uuid)) {
        gl_context_trials_add(trials, "%s: is %s", target.name,
                              context->facts.device_uuid[0] ? context->facts.device_uuid : "without a UUID");
        destroy(context);
        context = NULL;
    }
    return context;
}

static struct gl_device describe(const struct egl_library *egl, EGLDeviceEXT found, int index)
{
    const char *extensions = egl->query_device_string(found, EGL_EXTENSIONS);
    struct egl_target target = device_target(egl, found, index);
    struct gl_device device = {.is_software = has_word(extensions, "EGL_MESA_device_software"), .cuda_number = -1};
    EGLAttrib number;

    memcpy(device.uuid, target.uuid, sizeof device.uuid);
    if (egl->query_device_attribute && has_word(extensions, "EGL_NV_device_cuda") &&
        egl->query_device_attribute(found, EGL_CUDA_DEVICE_NV, &number))
        device.cuda_number = (int)number;
    return device;
}

// The devices to try: GPUs in turn, the one that `wanted` names among all, or those that render as `in_software` says.
static size_t choose(const struct gl_device *devices, size_t count, bool in_software, const char *wanted, int *order)
{
    size_t chosen = 0;
    int turn;

    if (wanted && gl_device_read_turn(wanted, &turn))
        return gl_device_order(devices, count, turn, getenv("CUDA_VISIBLE_DEVICES"), order);
    for (size_t i = 0; i < count; i++)
        if (wanted || devices[i].is_software == in_software) order[chosen++] = (int)i;
    return chosen;
}

// Returns a context on the first device that works: a software device or a GPU as `in_software` says, or the one that
// `wanted` names, whichever it is.
static struct gl_context *create_on_devices(const struct egl_library *egl, bool in_software, const char *wanted,
                                            struct gl_context_trials *trials)
{
    EGLDeviceEXT found[DEVICE_LIMIT];
    struct gl_device devices[DEVICE_LIMIT];
    int order[DEVICE_LIMIT];
    EGLint count = 0;
    size_t candidates;
    const char *name;
    int turn;

    if (!egl->query_devices || !egl->query_device_string || !egl->query_devices(DEVICE_LIMIT, found, &count)) count = 0;
    for (int i = 0; i < count; ++i)
        devices[i] = describe(egl, found[i], i);
    candidates = choose(devices, (size_t)count, in_software, wanted, order);
    name = wanted && gl_device_read_turn(wanted, &turn) ? NULL : wanted;
    for (size_t k = 0; k < candidates && k < (size_t)count; ++k) {
        struct gl_context *context = create_on_device(egl, found[order[k]], order[k], name, trials);

        if (context && !name && context->facts.is_software != in_software) {
            gl_context_trials_add(trials, "egl device %d: renders in software", order[k]);
            destroy(context);
            context = NULL;
        }
        if (context) return context;
    }
    if (candidates == 0) gl_context_trials_add(trials, "egl: no %s device", in_software ? "software" : "GPU");
    if (name) gl_context_trials_add(trials, "egl: no usable device \"%s\" among %d", name, (int)count);
    return NULL;
}

struct gl_context *gl_context_egl_create_hardware(const char *device, struct gl_context_trials *trials)
{
    struct egl_library egl = {0};

    return load_library(&egl, trials) ? create_on_devices(&egl, false, device, trials) : NULL;
}

struct gl_context *gl_context_egl_create_software(const char *device, struct gl_context_trials *trials)
{
    static const struct egl_target surfaceless = {
        .platform = EGL_PLATFORM_SURFACELESS_MESA, .native = EGL_DEFAULT_DISPLAY, .name = "egl surfaceless"};
    struct egl_library egl = {0};
    struct gl_context *context;

    if (!load_library(&egl, trials)) return NULL;
    context = create_on_devices(&egl, true, device, trials);
    if (context || device) return context;
    if (!has_word(egl.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_MESA_platform_surfaceless")) return NULL;
    return create_at(&egl, &surfaceless, trials);
}
