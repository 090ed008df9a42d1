// Measures how long a GPU works, by its own clock.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct gl_context;
struct gl_timer;

// Returns NULL where the context renders in software, whose time the caller measures itself, or lacks a function that
// is needed. The context outlives the timer.
struct gl_timer *gl_timer_create(const struct gl_context *context);
void gl_timer_destroy(struct gl_timer *timer); // accepts NULL
// gl_timer_end waits for the commands between the two calls and returns the seconds from the start of the first to the
// end of the last, pauses included.
void gl_timer_begin(struct gl_timer *timer);
double gl_timer_end(struct gl_timer *timer);
