// Jobs that are over leave the queue by the rules of the settings, one after the other; their files stay.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct farm;
struct job_ageing;

struct job_ageing *job_ageing_create(struct farm *farm);
void job_ageing_destroy(struct job_ageing *ageing); // after the loop has ended; accepts NULL
// To be called several times a second: looks every ten seconds whether jobs are to leave, step by step.
void job_ageing_run(struct job_ageing *ageing);
void job_ageing_note_settings(struct job_ageing *ageing); // the rules may have changed: looks at once
void job_ageing_stop(struct job_ageing *ageing);          // begins no more deletions
