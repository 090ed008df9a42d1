// Files below the output roots that no other job may write yet: those of jobs on their way in, and those being removed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/farm/job_table.h"

#include <stdbool.h>
#include <stdint.h>

struct farm;

// On the farm's list of claims for as long as the submission or the removal takes. Its owner frees it. Pointers are borrowed.
struct output_claim {
    struct job_files files;
    const char *name; // of the job on its way in
    const struct job_record
        *removed; // the job whose files are removed from their folder, which may go as well; NULL: none
    struct output_claim *next;
};

void output_claims_add(struct farm *farm, struct output_claim *claim);
void output_claims_remove(struct farm *farm, const struct output_claim *claim);

// Whether a job on its way in writes into the folder of `files`.
bool output_claims_use_folder(const struct farm *farm, const struct job_files *files);
// The name of a job on its way in that writes one of `files`, `*frame` there; NULL: none does.
const char *output_claims_find_collision(const struct farm *farm, const struct job_files *files, int32_t *frame);
// The job whose files are being removed from the folder of `files`; NULL: none.
const struct job_record *output_claims_find_removal(const struct farm *farm, const struct job_files *files);
