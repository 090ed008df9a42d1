// How quickly random paths of each kind are traced here, by which the seconds of frames are foretold.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum { SCATTER_PACE_KINDS = 3 }; // walks from nodes, particles from lights, paths of pixels

struct scatter_setting;

// Of one kind: the measurement of the most paths. The zero value has none.
struct scatter_pace {
    double paths;
    double processor_s, wall_s; // for all of them
};

// The clocks at the beginning of a measurement.
struct scatter_pace scatter_pace_begin(void);
// Notes a measurement of a setting in a picture of so many pixels, which has ended.
void scatter_pace_note(struct scatter_pace paces[static SCATTER_PACE_KINDS], const struct scatter_setting *setting,
                       double pixels, const struct scatter_pace *began);
// What a frame of so many pixels takes, times their samples; all 0 where nothing is known.
struct scatter_pace scatter_pace_foretell(const struct scatter_pace paces[static SCATTER_PACE_KINDS],
                                          const struct scatter_setting *setting, double pixels);
