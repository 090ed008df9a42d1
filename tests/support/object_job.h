// A job around a scene of objects.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

// Reads a job of 48x32 pixels whose camera looks from (0, 0, 4) at the origin, with depth and transmittance. `scene`
// are the members of its scene ("\"objects\": [...]"), `rest` members of the job beside frames, camera, scene and
// output. Fails the test when they are wrong. Free with job_finish.
void object_job_parse(struct job *job, const char *scene, const char *rest);

#define OBJECT_JOB_BALL(material)                                                                                      \
    "{\"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1, \"material\": {" material "}}"
#define OBJECT_JOB_FLOOR(material)                                                                                     \
    "{\"kind\": \"plane\", \"point\": [0, -1.5, 0], \"normal\": [0, 1, 0], \"material\": {" material "}}"
#define OBJECT_JOB_GREY "\"kind\": \"diffuse\", \"albedo\": 0.5"
#define OBJECT_JOB_MIRROR "\"kind\": \"mirror\""
#define OBJECT_JOB_GLASS "\"kind\": \"dielectric\", \"ior\": 1.5"
#define OBJECT_JOB_LIGHT "\"lights\": [{\"kind\": \"point\", \"intensity\": 30, \"position\": [2, 3, 3]}]"
#define OBJECT_JOB_QUALITY "\"quality\": {\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.05}"
