// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/intent.h"

#include "core/job/output_path.h"
#include "core/wire/publish.h"
#include "daemon/farm/job_table.h"

#include <string.h>

// `farm` is of the part file's name: NULL for one of an older version.
static bool settle_part(const struct job_record *record, const struct store_frame *row, const char *farm, int folder_fd)
{
    const struct output_part names = {.farm = farm,
                                      .job = record->id,
                                      .epoch = row->epoch,
                                      .frame = frame_range_at(&record->queued->frames, row->index),
                                      .attempt = row->attempts};
    struct published_file file = {.inode = row->inode, .size_bytes = row->size_bytes};
    char part[OUTPUT_NAME_SIZE], name[OUTPUT_NAME_SIZE];
    enum publish_state found;

    memcpy(file.hash, row->hash, sizeof file.hash);
    output_path_format_part(&record->path, &names, part);
    output_path_format_name(&record->path, names.frame, name);
    found = publish_settle(folder_fd, part, name, &file);
    return (found == PUBLISH_DONE || (found == PUBLISH_PENDING && publish_file(folder_fd, part, name, &file, NULL))) &&
           publish_sync(folder_fd, NULL);
}

bool intent_settle(const struct job_record *record, const struct store_frame *row, const char *farm, int folder_fd)
{
    return settle_part(record, row, farm, folder_fd) || settle_part(record, row, NULL, folder_fd);
}
