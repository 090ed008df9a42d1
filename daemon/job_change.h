// What a client may do to a job it submitted: pause, resume, cancel, retry, give another priority.
#pragma once

struct answer;
struct farm;
struct job_record;
struct frame_range;

// Each changes the job at once; the caller stores it. `user` is who asks.
void job_change_pause(struct farm *farm, struct job_record *record, const char *user);
void job_change_resume(struct farm *farm, struct job_record *record);
void job_change_cancel(struct farm *farm, struct job_record *record, const char *user);
void job_change_set_priority(struct farm *farm, struct job_record *record, int priority);

// Queues again the frames in one of `states` (bits) and in `range` (moves in; empty: all), commits that, and sends the
// answer. A job whose leftovers are being removed is retried when that is done.
void job_change_retry(struct farm *farm, struct job_record *record, unsigned states, struct frame_range *range,
                      struct answer *answer);
void job_change_retry_waiting(struct farm *farm, struct job_record *record); // its leftovers are removed
