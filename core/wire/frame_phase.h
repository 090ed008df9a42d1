// What is done to a frame while it is running.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum frame_phase {
    FRAME_PHASE_NONE,   // it is not being worked on
    FRAME_PHASE_ENCODE, // its picture exists; the file is written and checked
    // A worker does one of these at a time, while another frame may be encoded.
    FRAME_PHASE_LINK, // GL makes a program, as a part of one of the following phases
    FRAME_PHASE_PLAN, // the method of its segment of the animation is chosen
    FRAME_PHASE_RENDER,
    FRAME_PHASE_AUDIT // its error is measured
};
enum { FRAME_PHASE_COUNT = FRAME_PHASE_AUDIT + 1 };

// Their names in messages; "none" comes first, NULL last.
extern const char *const frame_phase_names[FRAME_PHASE_COUNT + 1];
