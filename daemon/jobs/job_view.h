// Jobs and frames as clients see them: the objects of docs/protocol.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct farm;
struct job_record;
struct json_writer;

void job_view_write(const struct farm *farm, struct job_record *record, struct json_writer *writer);
// The members of *job* without the braces around them.
void job_view_write_members(const struct farm *farm, struct job_record *record, struct json_writer *writer);
// Why the job waits or failed; NULL: it does neither. Owned by the caller.
char *job_view_format_reason(const struct farm *farm, const struct job_record *record);
