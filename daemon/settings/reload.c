// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/reload.h"

#include "daemon/settings/options.h"

#include <stdint.h>
#include <string.h>

static void add_name(char names[static RELOAD_NAMES_SIZE], const char *name)
{
    size_t length = strlen(names);

    if (length + strlen(name) + sizeof ", " > RELOAD_NAMES_SIZE) return;
    if (length > 0) strcpy(names + length, ", ");
    strcat(names, name);
}

static void take_integer(int64_t *held, int64_t fresh, const char *name, struct reload_changes *changes)
{
    if (*held == fresh) return;
    *held = fresh;
    add_name(changes->held, name);
}

static bool is_same_text(const char *a, const char *b)
{
    return a && b ? strcmp(a, b) == 0 : a == b;
}

static void take_text(char **held, char **fresh, const char *name, struct reload_changes *changes)
{
    char *before = *held;

    if (is_same_text(*held, *fresh)) return;
    *held = *fresh;
    *fresh = before;
    add_name(changes->held, name);
}

static bool is_same_list(const struct path_list *a, const struct path_list *b)
{
    if (a->count != b->count) return false;
    for (size_t i = 0; i < a->count; i++)
        if (strcmp(a->paths[i], b->paths[i]) != 0) return false;
    return true;
}

static void take_list(struct path_list *held, struct path_list *fresh, const char *name, struct reload_changes *changes)
{
    struct path_list before = *held;

    if (is_same_list(held, fresh)) return;
    *held = *fresh;
    *fresh = before;
    add_name(changes->held, name);
}

// They say where the daemon itself is and what its workers are.
static void note_waiting(const struct options *held, const struct options *fresh, struct reload_changes *changes)
{
    const struct {
        const char *name;
        bool is_same;
    } fixed[] = {
        {"state", is_same_text(held->state_folder, fresh->state_folder)},
        {"socket", is_same_text(held->socket_path, fresh->socket_path)},
        {"workers", held->worker_count == fresh->worker_count},
        {"threads", held->thread_count == fresh->thread_count},
        {"backend", is_same_text(held->backend, fresh->backend)},
        {"worker-program", is_same_text(held->worker_program, fresh->worker_program)},
        {"shader-dir", is_same_text(held->shader_folder, fresh->shader_folder)},
        {"sandbox", held->has_sandbox == fresh->has_sandbox},
    };

    for (size_t i = 0; i < sizeof fixed / sizeof fixed[0]; i++)
        if (!fixed[i].is_same) add_name(changes->waiting, fixed[i].name);
}

void reload_take(struct options *held, struct options *fresh, struct reload_changes *changes)
{
    int64_t level = held->log_level, attempts = held->max_attempts;

    *changes = (struct reload_changes){0};
    note_waiting(held, fresh, changes);
    take_list(&held->output_roots, &fresh->output_roots, "output-root", changes);
    take_list(&held->input_roots, &fresh->input_roots, "input-root", changes);
    take_text(&held->admin_group, &fresh->admin_group, "admin-group", changes);
    take_integer(&attempts, fresh->max_attempts, "max-attempts", changes);
    take_integer(&held->stop_timeout_ms, fresh->stop_timeout_ms, "stop-timeout", changes);
    take_integer(&held->progress_limit_ms, fresh->progress_limit_ms, "progress-limit", changes);
    take_integer(&held->user_jobs, fresh->user_jobs, "user-jobs", changes);
    take_integer(&held->user_frames, fresh->user_frames, "user-frames", changes);
    take_integer(&held->user_pixels, fresh->user_pixels, "user-pixels", changes);
    take_integer(&held->user_disk_bytes, fresh->user_disk_bytes, "user-disk", changes);
    take_integer(&held->worker_memory_bytes, fresh->worker_memory_bytes, "worker-memory", changes);
    take_integer(&level, (int64_t)fresh->log_level, "log-level", changes);
    held->max_attempts = (int)attempts;
    held->log_level = (enum log_level)level;
}
