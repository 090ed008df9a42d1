// A job with a ball of constant density around the origin.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

// Reads a job whose camera looks from (0, 0, 4) at the origin, where a ball of radius 1 m has density 1 throughout.
// `medium` are members of the medium beside its density ("\"sigma_a\": 1"), `rest` members of the job beside frames,
// camera, scene and output ("\"lights\": [], \"quality\": {...}"). Fails the test when they are wrong. Free with
// job_finish.
void ball_job_parse(struct job *job, const char *medium, const char *rest);

#define BALL_JOB_SIGMA_S_1 "\"sigma_s\": 1, \"sigma_a\": 0"
#define BALL_JOB_SIGMA_A_1 "\"sigma_s\": 0, \"sigma_a\": 1"
#define BALL_JOB_MIDPOINT "\"quality\": {\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.05}"
#define BALL_JOB_RIEMANN "\"quality\": {\"method\": \"riemann\", \"step\": 0.05, \"light_steps\": 16}"
#define BALL_JOB_POINT_LIGHT "\"lights\": [{\"kind\": \"point\", \"intensity\": 3, \"position\": [2, 1, 2]}]"
