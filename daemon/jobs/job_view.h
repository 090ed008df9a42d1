// A job as clients see it: the object *job* of docs/protocol.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/frame_phase.h"

struct farm;
struct job_etas;
struct job_record;
struct json_writer;

// `etas` is one for all jobs that are written at a time.
void job_view_write(const struct farm *farm, struct job_etas *etas, struct job_record *record,
                    struct json_writer *writer);
// The members `phase` and `phase_progress`; null for FRAME_PHASE_NONE, and for a negative progress.
void job_view_write_phase(enum frame_phase phase, double progress, struct json_writer *writer);
// The members of the object without its braces.
void job_view_write_members(const struct farm *farm, struct job_etas *etas, struct job_record *record,
                            struct json_writer *writer);
// Members that tell what became of the job, without those that may be long or soon wrong. `why` stands in place of its
// reason; NULL: the job's own.
void job_view_write_outline(const struct farm *farm, struct job_record *record, const char *why,
                            struct json_writer *writer);
// Why no worker can render the job; NULL: some can. Owned by the caller.
char *job_view_format_lack(const struct farm *farm, const struct job_record *record);
