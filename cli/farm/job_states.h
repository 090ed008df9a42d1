// States of jobs or frames as users list them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct json_writer;

// Writes the member "state" as an array, from "failed,canceled"; writes nothing when `states` is NULL.
void job_states_write(struct json_writer *params, const char *states);
