// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/root_settings.h"

#include "core/base/error.h"
#include "core/base/log.h"
#include "core/base/path_list.h"
#include "daemon/farm/farm.h"
#include "daemon/output/root_watch.h"
#include "daemon/service/folders.h"
#include "daemon/store/store_reader.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

static bool on_root(void *user, const struct store_root *row, struct error *error)
{
    struct farm *farm = user;

    if (!row->path || !row->id || !root_marker_is_id(row->id)) {
        error_set(error, "store: output root %s has the id %s, expected 32 hexadecimal digits",
                  row->path ? row->path : "(none)", row->id ? row->id : "(none)");
        return false;
    }
    memcpy(root_table_add(&farm->roots, row->path)->id, row->id, ROOT_MARKER_ID_SIZE);
    return true;
}

bool root_settings_load(struct farm *farm, struct error *error)
{
    return store_read_farm(farm->reader, farm->id, error) && store_read_roots(farm->reader, on_root, farm, error);
}

static bool has_jobs(const struct farm *farm, const struct root *root)
{
    for (size_t i = 0; i < farm->jobs.count; i++)
        if (farm->jobs.records[i]->output_root == root) return true;
    return false;
}

// What was a root before is not made again: its disk may come back.
static void make_first(const struct farm *farm, const struct root *root)
{
    struct error error;

    if (!root->id[0] && !has_jobs(farm, root) && !folders_make(root->path, 0755, &error))
        log_warn("output root %s cannot be made: %s", root->path, error.message);
}

static void look(struct farm *farm, struct root *root, root_settings_on_op *on_op, void *user)
{
    root->is_watched = true;
    if (root_watch_look(farm, root)) on_op(user, root_watch_format_op(root));
    if (!root->is_there) log_warn("%s; jobs that write there wait until it is", root->trouble);
}

void root_settings_take(struct farm *farm, const struct path_list *roots, root_settings_on_op *on_op, void *user)
{
    for (size_t i = 0; i < roots->count; i++) {
        struct root *root = root_table_add(&farm->roots, roots->paths[i]);

        if (i == 0) make_first(farm, root);
        if (!root->is_watched) look(farm, root, on_op, user);
    }
    for (size_t i = 0; i < farm->roots.count; i++) {
        struct root *root = farm->roots.roots[i];

        if (!root->is_watched && has_jobs(farm, root)) look(farm, root, on_op, user);
    }
}

void root_settings_tell_inputs(const struct path_list *roots)
{
    for (size_t i = 0; i < roots->count; i++)
        if (access(roots->paths[i], F_OK) != 0)
            log_warn("input root %s is not there: %s; jobs that read files below it are refused", roots->paths[i],
                     strerrordesc_np(errno));
}
