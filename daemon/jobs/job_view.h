// A job as clients see it: the object *job* of docs/protocol.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct farm;
struct job_record;
struct json_writer;

void job_view_write(const struct farm *farm, struct job_record *record, struct json_writer *writer);
// The members of the object without its braces.
void job_view_write_members(const struct farm *farm, struct job_record *record, struct json_writer *writer);
