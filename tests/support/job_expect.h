// Reads the text of a job, or expects its refusal with a message.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

// Absolute output paths must lie below JOB_EXPECT_ROOT.
#define JOB_EXPECT_ROOT "/srv/out"

// Reads `text`; a refusal fails the test. Free with job_finish.
struct job job_expect(const char *text);
// The message must be `expected`, and the job empty.
void job_expect_refused(const char *text, const char *expected);
// The same of `text` with `value` (JSON; NULL removes) at `path`; see json_edit.h.
void job_expect_edit_refused(const char *text, const char *path, const char *value, const char *expected);
// Whether a machine that sees `text` alone can read the job's files: the message is `expected`, NULL if it can.
void job_expect_no_inputs(const char *text, const char *expected);
