// How an attempt to deliver ended.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct notify_line;

enum notify_outcome {
    NOTIFY_DELIVERED,
    NOTIFY_FAILED,  // another attempt may succeed
    NOTIFY_HOPELESS // none will
};

// `line` is what was sent; `why` is NULL when it is delivered.
typedef void notify_on_end(void *user, struct notify_line *line, enum notify_outcome outcome, const char *why);
