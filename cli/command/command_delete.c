// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/program/options.h"
#include "core/base/error.h"
#include "core/json/json_write.h"

#include <inttypes.h>
#include <stdio.h>

static void print_files(int64_t id, int64_t removed, int64_t kept, int64_t found)
{
    printf("job %" PRId64 ": deleted, with %" PRId64 " file%s", id, removed, removed == 1 ? "" : "s");
    if (kept > 0)
        printf("; %" PRId64 " stay%s: changed since, or retried and not rendered again", kept, kept == 1 ? "s" : "");
    if (found > 0) printf("; %" PRId64 " that it found there and did not render stay%s", found, found == 1 ? "s" : "");
    printf("\n");
}

static bool tell_deleted(const struct json_node *result, int64_t id, struct json_writer *results, struct error *error)
{
    struct json_node removed_node = json_node_child(result, "files_removed");
    struct json_node kept_node = json_node_child(result, "files_kept");
    struct json_node missing_node = json_node_child(result, "files_missing");
    struct json_node found_node = json_node_child(result, "files_found");
    int64_t removed, kept, missing, found;

    if (!json_read_integer(&removed_node, 0, INT64_C(1) << 52, &removed, error) ||
        !json_read_integer(&kept_node, 0, INT64_C(1) << 52, &kept, error) ||
        !json_read_integer(&missing_node, 0, INT64_C(1) << 52, &missing, error) ||
        !json_read_integer(&found_node, 0, INT64_C(1) << 52, &found, error))
        return false;
    if (results) {
        json_write_begin_object(results);
        json_write_integer_member(results, "id", id);
        json_write_integer_member(results, "files_removed", removed);
        json_write_integer_member(results, "files_kept", kept);
        json_write_integer_member(results, "files_missing", missing);
        json_write_integer_member(results, "files_found", found);
        json_write_end_object(results);
    } else if (removed > 0 || kept > 0 || found > 0) {
        print_files(id, removed, kept, found);
    } else {
        printf("job %" PRId64 ": deleted\n", id);
    }
    if (missing == 0) return true;
    error_set(error,
              "job %" PRId64 ": %" PRId64 " of its files were not there: if they are elsewhere, remove them there", id,
              missing);
    return false;
}

enum exit_status command_delete(const struct options *options, struct error *error)
{
    return daemon_call_each(options,
                            &(struct daemon_call_each){.method = "job.delete",
                                                       .more = options->files ? ",\"files\":true" : "",
                                                       .key = "deleted",
                                                       .report = tell_deleted,
                                                       .selection = {"delete", "succeeded,failed,canceled"}},
                            error);
}
