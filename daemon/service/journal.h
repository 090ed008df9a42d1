// Sends log lines to systemd's journal, with job, frame and attempt as fields.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/log.h"

#include <stdbool.h>
#include <stddef.h>

enum { JOURNAL_ENTRY_SIZE = LOG_LINE_SIZE + 1024 };

// Sends log lines to the journal when standard error is the journal's stream and `socket_path` is writable; returns
// whether that is so. `stream` is the value of JOURNAL_STREAM, "device:inode"; NULL: not set. Logging never blocks: a
// line that the journal does not take at once is lost, and the next line that it takes is preceded by the count of lost
// lines.
bool journal_open(const char *stream, const char *socket_path);
void journal_close(void); // lines go to standard error again; always legal

extern const char journal_socket_path[]; // of systemd
// Writes the entry in the journal's native protocol; returns its length.
size_t journal_format_entry(char entry[static JOURNAL_ENTRY_SIZE], enum log_level level,
                            const struct log_subject *subject, const char *line);
