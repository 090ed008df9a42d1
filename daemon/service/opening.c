// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/opening.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/root_marker.h"
#include "daemon/settings/options.h"
#include "daemon/store/store.h"
#include "daemon/store/store_backup.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

enum { STEP_S = 1, EXTENSION_US = 30 * 1000 * 1000 };

// One step of the wait; `*is_waiting` is set by the first.
static void wait(const char *folder, const struct error *cause, bool *is_waiting)
{
    if (!*is_waiting) log_error("%s: the start waits for room in %s", cause->message, folder);
    *is_waiting = true;
    sd_notifyf(0, "STATUS=the start waits for room in %s: %s\nEXTEND_TIMEOUT_USEC=%d", folder, cause->message,
               EXTENSION_US);
    sleep(STEP_S);
}

// What says that the folder had a store; NULL: nothing. Owned by the caller.
static char *find_trace(const struct options *options)
{
    static const char *const names[] = {STORE_BACKUP_NAME, "counts"};
    char farm[ROOT_MARKER_ID_SIZE];

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char *path = xasprintf("%s/%s", options->state_folder, names[i]);

        if (access(path, F_OK) == 0) return path;
        free(path);
    }
    for (size_t i = 0; i < options->output_roots.count; i++) {
        const char *root = options->output_roots.paths[i];

        if (root_marker_find_farm(root, options->state_folder, farm)) return xasprintf("%s/" ROOT_MARKER_NAME, root);
    }
    return NULL;
}

bool opening_check_new(const struct options *options, struct error *error)
{
    char *path = xasprintf("%s/queue.db", options->state_folder);
    char *restored = xasprintf("%s/" STORE_RESTORED_NAME, options->state_folder);
    struct stat status;
    bool is_there = (stat(path, &status) == 0 && status.st_size > 0) || access(restored, F_OK) == 0;
    char *trace = is_there || options->may_be_new ? NULL : find_trace(options);

    if (trace)
        error_set(error,
                  "store: there is no %s, but %s says that a farm was here: mount its disk, put a backup back"
                  " (march restore %s %s), or begin a new farm (marchd --new-store)",
                  path, trace, strstr(trace, STORE_BACKUP_NAME) ? trace : "FILE", options->state_folder);
    free(path);
    free(restored);
    free(trace);
    return is_there || options->may_be_new || !trace;
}

static void note_room(const char *folder, bool was_waiting)
{
    if (was_waiting) log_info("%s has room again: the start goes on", folder);
}

struct store *opening_wait(const char *folder, struct error *error)
{
    bool is_full = false, is_waiting = false;
    struct store *store;

    while (!(store = store_open(folder, &is_full, error)) && is_full)
        wait(folder, error, &is_waiting);
    if (store) note_room(folder, is_waiting);
    return store;
}

bool opening_commit(struct store *store, const char *folder, const struct store_op *ops, size_t op_count,
                    struct error *error)
{
    bool is_waiting = false, ok;

    while (!(ok = store_commit(store, ops, op_count, error)) && store_is_full(store))
        wait(folder, error, &is_waiting);
    if (ok) note_room(folder, is_waiting);
    return ok;
}
