// Volumes from files that no frame shows: a worker looks at the files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job_warnings.h"

struct job;
struct options;

// As job_warnings_find, for what only the files tell; a file that cannot be read is told, too. Where no worker can be
// started nothing is.
void unseen_report_find(const struct options *options, const struct job *job, const char *document,
                        job_warnings_on_found *on_found, void *user);
