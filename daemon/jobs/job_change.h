// Changes that a client asks for: pause, resume, cancel, priority.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct farm;
struct job_record;

// Each changes the job at once; the caller stores it. `user` names the client.
void job_change_pause(struct farm *farm, struct job_record *record, const char *user);
void job_change_resume(struct farm *farm, struct job_record *record, const char *user);
void job_change_cancel(struct farm *farm, struct job_record *record, const char *user);
void job_change_set_priority(struct farm *farm, struct job_record *record, int priority, const char *user);
