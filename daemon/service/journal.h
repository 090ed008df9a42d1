// Sends the daemon's lines to systemd's journal, with job, frame and attempt as fields.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/log.h"

#include <stdbool.h>
#include <stddef.h>

enum { JOURNAL_ENTRY_SIZE = LOG_LINE_SIZE + 1024 };

// From now on the program's lines go to the journal, where standard error is the journal's stream (`stream` is what
// JOURNAL_STREAM says: "device:inode"; NULL: not set) and `socket_path` may be written to. Returns whether they do.
// A line never waits: what the journal does not take at once is lost, and the next that it takes says how many were.
bool journal_open(const char *stream, const char *socket_path);
void journal_close(void); // lines go to standard error again; legal always

extern const char journal_socket_path[]; // systemd's
// The entry that is sent, as the journal's native protocol has it; returns its length.
size_t journal_format_entry(char entry[static JOURNAL_ENTRY_SIZE], enum log_level level,
                            const struct log_subject *subject, const char *line);
