// Settings that are read again while the daemon runs: which hold at once, and which wait for a restart.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct options;

enum { RELOAD_NAMES_SIZE = 512 };

// Names of settings, as on the command line and with commas between; empty: none.
struct reload_changes {
    char held[RELOAD_NAMES_SIZE];    // they changed, and hold now
    char waiting[RELOAD_NAMES_SIZE]; // they changed in the file, and need a restart
};

// Takes into `held` what may change while the daemon runs, and leaves in `fresh` what was there.
void reload_take(struct options *held, struct options *fresh, struct reload_changes *changes);
