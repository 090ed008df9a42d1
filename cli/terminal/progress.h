// Shows progress: live lines on a terminal, one for each job; elsewhere a plain line from time to time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

// The progress of a job. Strings are borrowed and may be NULL.
struct progress {
    const char *label;
    const char *state; // shown when it is not "running"
    int64_t total;
    int64_t done;             // succeeded or skipped
    int64_t failed;           // failed or canceled
    double seconds_per_frame; // negative: unknown
    double eta_s;             // negative: unknown
    const char *reason;       // why the job waits or failed
    const char *phase;        // what is done to its frames, as in "plan"
    double phase_progress;    // 0: nothing is shown of it
};

// A line of at most `width` columns without newline; a bar fills the space that remains. Owned by the caller.
char *progress_format(const struct progress *progress, int width, bool has_color);
// "succeeded", "failed: ...": the state and why; a reason that begins with the state's word says both, as in "paused by
// ann". `reason` may be NULL. Owned by the caller.
char *progress_format_state(const char *state, const char *reason);
// "1.2 s", "4:05", "2:03:09", "3 d 04:00"; owned by the caller.
char *progress_format_duration(double seconds);
// "<0.001", "0.0231", "6.41", "1234": seconds a frame; owned by the caller.
char *progress_format_pace(double seconds_per_frame);

// The state of what is shown. The zero value: nothing.
struct progress_display {
    FILE *out; // borrowed
    bool is_live;
    bool has_color;
    int lines;          // on the screen; the cursor is below them
    int64_t next_ms;    // earliest time of the next drawing, unless another job is held
    uint64_t held_hash; // of the jobs that are held
    uint64_t last_hash; // of the last text of a plain display
};

// Live when `out` is a terminal that understands cursor movement; coloured unless NO_COLOR is set.
void progress_display_init(struct progress_display *display, FILE *out);
// Draws at most 10 times a second when live; otherwise every 5 s, and only changes, but at once when
// another job is held. `is_final` always draws.
void progress_display_draw(struct progress_display *display, const struct progress *jobs, size_t count, int64_t now_ms,
                           bool is_final);
// Removes the live lines so that other text can be printed; the next draw restores them.
void progress_display_clear(struct progress_display *display);
int64_t progress_now_ms(void); // monotonic
