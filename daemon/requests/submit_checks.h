// Whether a client may submit a job: who they are, where its folder is, whom it names. Code and error are filled else.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct job;
struct request;

bool submit_checks_peer(struct request *request); // the system says who the client is
// The job has a folder of its own below the root, unless the client is an administrator.
bool submit_checks_folder(struct request *request, const struct job *job, const char *root);
bool submit_checks_after(struct request *request, const struct job *job); // the jobs that it comes after are known
// The farm can tell those whom the job's rules name, as far as it knows.
bool submit_checks_targets(struct request *request, const struct job *job);
