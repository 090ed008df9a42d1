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

static void take_integer(int64_t *current, int64_t fresh, const char *name, struct reload_changes *changes)
{
    if (*current == fresh) return;
    *current = fresh;
    add_name(changes->applied, name);
}

static bool is_same_text(const char *a, const char *b)
{
    return a && b ? strcmp(a, b) == 0 : a == b;
}

static void take_text(char **current, char **fresh, const char *name, struct reload_changes *changes)
{
    char *before = *current;

    if (is_same_text(*current, *fresh)) return;
    *current = *fresh;
    *fresh = before;
    add_name(changes->applied, name);
}

static bool is_same_list(const struct path_list *a, const struct path_list *b)
{
    if (a->count != b->count) return false;
    for (size_t i = 0; i < a->count; i++)
        if (strcmp(a->paths[i], b->paths[i]) != 0) return false;
    return true;
}

static void take_list(struct path_list *current, struct path_list *fresh, const char *name,
                      struct reload_changes *changes)
{
    struct path_list before = *current;

    if (is_same_list(current, fresh)) return;
    *current = *fresh;
    *fresh = before;
    add_name(changes->applied, name);
}

// These settings define where the daemon is and what its workers are.
static void note_waiting(const struct options *current, const struct options *fresh, struct reload_changes *changes)
{
    const struct {
        const char *name;
        bool is_same;
    } fixed[] = {
        {"state", is_same_text(current->state_folder, fresh->state_folder)},
        {"socket", is_same_text(current->socket_path, fresh->socket_path)},
        {"workers", current->worker_count == fresh->worker_count},
        {"threads", current->thread_count == fresh->thread_count},
        {"backend", is_same_text(current->backend, fresh->backend)},
        {"worker-program", is_same_text(current->worker_program, fresh->worker_program)},
        {"shader-dir", is_same_text(current->shader_folder, fresh->shader_folder)},
        {"launch-socket", is_same_text(current->launch_socket, fresh->launch_socket)},
        {"pool", pool_table_is_same(&current->pools, &fresh->pools)},
        {"sandbox", current->has_sandbox == fresh->has_sandbox},
    };

    for (size_t i = 0; i < sizeof fixed / sizeof fixed[0]; i++)
        if (!fixed[i].is_same) add_name(changes->waiting, fixed[i].name);
}

static void take_weights(struct user_weights *current, struct user_weights *fresh, struct reload_changes *changes)
{
    struct user_weights before = *current;

    if (user_weights_are_same(current, fresh)) return;
    *current = *fresh;
    *fresh = before;
    add_name(changes->applied, "user-weight");
}

static bool is_same_notify(const struct job_notify *a, const struct job_notify *b)
{
    if (a->count != b->count) return false;
    for (size_t i = 0; i < a->count; i++)
        if (a->rules[i].on != b->rules[i].on || strcmp(a->rules[i].to, b->rules[i].to) != 0) return false;
    return true;
}

static void take_notify(struct job_notify *current, struct job_notify *fresh, struct reload_changes *changes)
{
    struct job_notify before = *current;

    if (is_same_notify(current, fresh)) return;
    *current = *fresh;
    *fresh = before;
    add_name(changes->applied, "notify");
}

void reload_take(struct options *current, struct options *fresh, struct reload_changes *changes)
{
    int64_t level = current->log_level, attempts = current->max_attempts;

    *changes = (struct reload_changes){0};
    note_waiting(current, fresh, changes);
    take_list(&current->output_roots, &fresh->output_roots, "output-root", changes);
    take_list(&current->input_roots, &fresh->input_roots, "input-root", changes);
    take_text(&current->admin_group, &fresh->admin_group, "admin-group", changes);
    take_text(&current->web_user, &fresh->web_user, "web-user", changes);
    take_integer(&attempts, fresh->max_attempts, "max-attempts", changes);
    take_integer(&current->stop_timeout_ms, fresh->stop_timeout_ms, "stop-timeout", changes);
    take_integer(&current->progress_limit_ms, fresh->progress_limit_ms, "progress-limit", changes);
    take_integer(&current->frame_limit_ms, fresh->frame_limit_ms, "frame-limit", changes);
    take_integer(&current->user_jobs, fresh->user_jobs, "user-jobs", changes);
    take_integer(&current->user_frames, fresh->user_frames, "user-frames", changes);
    take_integer(&current->user_pixels, fresh->user_pixels, "user-pixels", changes);
    take_integer(&current->user_disk_bytes, fresh->user_disk_bytes, "user-disk", changes);
    take_integer(&current->keep_jobs, fresh->keep_jobs, "keep-jobs", changes);
    take_integer(&current->keep_ms, fresh->keep_ms, "keep-days", changes);
    take_integer(&current->keep_bytes, fresh->keep_bytes, "keep-bytes", changes);
    if (pool_table_swap_terms(&current->pools, &fresh->pools)) add_name(changes->applied, "pool");
    take_weights(&current->user_weights, &fresh->user_weights, changes);
    take_notify(&current->notify, &fresh->notify, changes);
    take_integer(&current->half_life_ms, fresh->half_life_ms, "half-life", changes);
    take_integer(&current->longest_wait_ms, fresh->longest_wait_ms, "longest-wait", changes);
    take_integer(&current->worker_memory_bytes, fresh->worker_memory_bytes, "worker-memory", changes);
    take_integer(&level, (int64_t)fresh->log_level, "log-level", changes);
    current->max_attempts = (int)attempts;
    current->log_level = (enum log_level)level;
}
