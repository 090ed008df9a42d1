// Looks at jobs, a few a second, for what their targets are to be told before they end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct farm;
struct job_record;
struct notice_watch;

struct notice_watch *notice_watch_open(struct farm *farm);
void notice_watch_close(struct notice_watch *watch); // frees itself when the loop closed its timer; accepts NULL

// Looks at the job now: why it waits, and whether frames missed. Does nothing for one whose end is told.
void notice_watch_look(struct farm *farm, struct job_record *record);
