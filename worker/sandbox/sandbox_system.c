// SPDX-License-Identifier: Apache-2.0
#include "worker/sandbox/sandbox_system.h"

#include "core/base/alloc.h"
#include "worker/sandbox/sandbox_landlock.h"
#include "worker/sandbox/sanitizer.h"

#include <dirent.h>
#include <elf.h>
#include <link.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// In /proc only this process is allowed, not other processes or kernel settings.
static const char *const read_paths[] = {
    // libraries, programs, and the settings of ld.so and drivers
    "/usr", "/lib", "/lib32", "/lib64", "/libx32", "/bin", "/opt", "/etc/ld.so.cache", "/etc/ld.so.conf",
    "/etc/ld.so.conf.d", "/etc/alternatives", "/etc/glvnd", "/etc/egl", "/etc/drirc", "/etc/nvidia", "/etc/localtime",
    "/etc/timezone", "/etc/locale.alias",
    // facts about the machine
    "/proc/self", "/proc/cpuinfo", "/proc/meminfo", "/proc/stat", "/proc/devices", "/proc/modules", "/proc/version",
    "/proc/filesystems", "/proc/driver/nvidia", "/proc/sys/kernel/osrelease", "/proc/sys/vm/overcommit_memory",
    "/proc/sys/vm/max_map_count", "/proc/sys/vm/mmap_min_addr", "/sys/devices", "/sys/dev", "/sys/bus", "/sys/module",
    "/sys/class/drm", "/sys/class/kfd", "/sys/fs/cgroup", "/sys/kernel/mm/transparent_hugepage"};

static const char *const device_paths[] = {"/dev/null",    "/dev/zero", "/dev/full", "/dev/random",
                                           "/dev/urandom", "/dev/dri",  "/dev/kfd",  "/dev/dxg"};

// Environment variables that name folders of libraries and drivers.
static const char *const path_variables[] = {"LD_LIBRARY_PATH",           "LIBGL_DRIVERS_PATH",
                                             "EGL_DRIVERS_PATH",          "GBM_BACKENDS_PATH",
                                             "__EGL_VENDOR_LIBRARY_DIRS", "__EGL_VENDOR_LIBRARY_FILENAMES"};

static bool allow_list(const struct sandbox_landlock *landlock, const char *const paths[], size_t count,
                       unsigned rights, struct error *error)
{
    for (size_t i = 0; i < count; i++)
        if (!sandbox_landlock_allow_path(landlock, paths[i], rights, error)) return false;
    return true;
}

static bool allow_variable(const struct sandbox_landlock *landlock, const char *name, struct error *error)
{
    static const char suppressions[] = "suppressions="; // an option of sanitizers, whose file they read at exit
    const char *value = getenv(name);
    char *copy = xstrdup(value ? value : ""), *rest = copy, *path;
    bool ok = true;

    while (ok && (path = strsep(&rest, ":"))) {
        if (strncmp(path, suppressions, strlen(suppressions)) == 0) path += strlen(suppressions);
        if (path[0] == '/') ok = sandbox_landlock_allow_path(landlock, path, SANDBOX_READ, error);
    }
    free(copy);
    return ok;
}

// A driver has a device node for each card, and some for itself.
static bool allow_nvidia(const struct sandbox_landlock *landlock, struct error *error)
{
    DIR *folder = opendir("/dev");
    struct dirent *entry;
    bool ok = true;

    while (ok && folder && (entry = readdir(folder))) {
        char *path;

        if (strncmp(entry->d_name, "nvidia", strlen("nvidia")) != 0) continue;
        path = xasprintf("/dev/%s", entry->d_name);
        ok = sandbox_landlock_allow_path(landlock, path, SANDBOX_DEVICE, error);
        free(path);
    }
    if (folder) closedir(folder);
    return ok;
}

bool sandbox_system_allow(const struct sandbox_landlock *landlock, const char *shader_folder, struct error *error)
{
    for (size_t i = 0; i < sizeof path_variables / sizeof path_variables[0]; i++)
        if (!allow_variable(landlock, path_variables[i], error)) return false;
    if (IS_SANITIZED && !allow_variable(landlock, "LSAN_OPTIONS", error)) return false;
    if (shader_folder && !sandbox_landlock_allow_path(landlock, shader_folder, SANDBOX_READ, error)) return false;
    return allow_list(landlock, read_paths, sizeof read_paths / sizeof read_paths[0], SANDBOX_READ, error) &&
           allow_list(landlock, device_paths, sizeof device_paths / sizeof device_paths[0], SANDBOX_DEVICE, error) &&
           allow_nvidia(landlock, error);
}

static int find_loader(struct dl_phdr_info *object, size_t size, void *user)
{
    for (int i = 0; i < object->dlpi_phnum; i++)
        if (object->dlpi_phdr[i].p_type == PT_INTERP)
            *(const char **)user = (const char *)(object->dlpi_addr + object->dlpi_phdr[i].p_vaddr);
    return 1; // the first object is this program
}

bool sandbox_system_allow_converter(const struct sandbox_landlock *landlock, struct error *error)
{
    const char *search = getenv("PATH"), *loader = NULL;
    char *copy = xstrdup(search ? search : "/usr/local/bin:/usr/bin:/bin"), *rest = copy, *folder;
    bool ok = true;

    while (ok && (folder = strsep(&rest, ":"))) {
        char *program = xasprintf("%s/nanovdb_convert", folder);
        bool is_it = folder[0] == '/' && access(program, X_OK) == 0;

        if (is_it) ok = sandbox_landlock_allow_path(landlock, program, SANDBOX_READ | SANDBOX_EXECUTE, error);
        free(program);
        if (is_it) break;
    }
    free(copy);
    dl_iterate_phdr(find_loader, &loader);
    if (ok && loader) ok = sandbox_landlock_allow_path(landlock, loader, SANDBOX_READ | SANDBOX_EXECUTE, error);
    return ok;
}
