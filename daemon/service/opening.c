// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/opening.h"

#include "core/base/error.h"
#include "core/base/log.h"
#include "daemon/store/store.h"

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
