// Settings that were read again while the daemon runs: some are applied at once, others need a restart.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct options;

enum { RELOAD_NAMES_SIZE = 512 };

// Names of changed settings, as on the command line, separated by commas; empty: none.
struct reload_changes {
    char applied[RELOAD_NAMES_SIZE]; // they hold now
    char waiting[RELOAD_NAMES_SIZE]; // they need a restart
};

// Moves the settings that may change while the daemon runs from `fresh` to `current`, and the old ones back.
void reload_take(struct options *current, struct options *fresh, struct reload_changes *changes);
