// Output files of jobs that are being submitted or deleted: no other job may write them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/farm/job_table.h"

#include <stdbool.h>
#include <stdint.h>

struct farm;

// A claim is on the farm's list during the submission or the deletion, whose memory holds it. Pointers are borrowed.
struct output_claim {
    struct job_files files;
    const char *name;                 // of the job that is being submitted
    const struct job_record *removed; // the job whose files are being removed; NULL: a submission
    struct output_claim *next;
};

void output_claims_add(struct farm *farm, struct output_claim *claim);
void output_claims_remove(struct farm *farm, const struct output_claim *claim);

// Whether a job that is being submitted writes into the folder of `files`.
bool output_claims_use_folder(const struct farm *farm, const struct job_files *files);
// The name of a job being submitted that writes one of `files`, whose frame is `*frame`; NULL: none.
const char *output_claims_find_collision(const struct farm *farm, const struct job_files *files, int32_t *frame);
// The job whose files are being removed from the folder of `files`; NULL: none.
const struct job_record *output_claims_find_removal(const struct farm *farm, const struct job_files *files);
