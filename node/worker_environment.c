// SPDX-License-Identifier: Apache-2.0
#include "node/worker_environment.h"

#include "core/base/alloc.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Beginnings of the variables that a worker gets: those of libraries, drivers, folders and languages. No other variable
// is passed on: it may lead to the daemon (NOTIFY_SOCKET, LISTEN_FDS, CREDENTIALS_DIRECTORY) or be a secret of the user
// who started it.
static const char *const kept_names[] = {
    "PATH=",  "HOME=",    "LANG=", "LC_",      "TZ=",    "TMPDIR=", "LD_",    "GLIBC_", "MALLOC_", "MESA_",
    "LIBGL_", "GALLIUM_", "LP_",   "EGL_",     "__EGL_", "__GL_",   "__GLX_", "DRI_",   "NVIDIA_", "CUDA_",
    "INTEL_", "RADEON_",  "AMD_",  "NOUVEAU_", "ASAN_",  "LSAN_",   "TSAN_",  "UBSAN_",
};

// Disk caches of drivers are off: a driver would load machine code that it compiled for one job into the worker of
// another.
static const char *const set_variables[] = {"MESA_SHADER_CACHE_DISABLE=true", "__GL_SHADER_DISK_CACHE=0",
                                            "CUDA_CACHE_DISABLE=1"};

enum { SET_COUNT = sizeof set_variables / sizeof set_variables[0] };

static const char threads_name[] = "LP_NUM_THREADS=";

static bool has_name_of(const char *variable, const char *other)
{
    size_t length = strcspn(other, "=") + 1;

    return strncmp(variable, other, length) == 0;
}

static bool is_kept(const char *variable)
{
    if (has_name_of(variable, threads_name)) return false;
    for (size_t i = 0; i < SET_COUNT; i++)
        if (has_name_of(variable, set_variables[i])) return false;
    for (size_t i = 0; i < sizeof kept_names / sizeof kept_names[0]; i++)
        if (strncmp(variable, kept_names[i], strlen(kept_names[i])) == 0) return true;
    return false;
}

char **worker_environment_create(int thread_count)
{
    size_t count = 0, kept = 0;
    char **environment;

    while (environ[count])
        count++;
    environment = xcalloc(count + SET_COUNT + 2, sizeof(char *));
    for (size_t i = 0; i < count; i++)
        if (is_kept(environ[i])) environment[kept++] = xstrdup(environ[i]);
    for (size_t i = 0; i < SET_COUNT; i++)
        environment[kept++] = xstrdup(set_variables[i]);
    environment[kept] = xasprintf("%s%d", threads_name, thread_count);
    return environment;
}

void worker_environment_destroy(char **environment)
{
    for (size_t i = 0; environment[i]; i++)
        free(environment[i]);
    free(environment);
}
