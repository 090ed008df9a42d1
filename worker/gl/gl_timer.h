// How long a GPU is at work, by its own clock.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct gl_context;
struct gl_timer;

// NULL where the context renders in software, whose time is the caller's, or lacks what it takes. The context outlives the timer.
struct gl_timer *gl_timer_create(const struct gl_context *context);
void gl_timer_destroy(struct gl_timer *timer); // accepts NULL
// Seconds from the first of the commands between these calls to the end of the last, pauses among them; gl_timer_end waits.
void gl_timer_begin(struct gl_timer *timer);
double gl_timer_end(struct gl_timer *timer);
