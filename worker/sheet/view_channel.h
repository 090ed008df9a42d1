// Which channels of a file are shown under a name that a person gives, and how.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

enum view_kind { VIEW_COLOUR, VIEW_GREY, VIEW_DEPTH };

// The zero value is empty.
struct view_channel {
    enum view_kind kind;
    bool is_light;  // has no upper bound: an exposure is chosen for it
    char *names[3]; // owned; of the file's channels; NULL: none
};

// "color" (or NULL) is R, G and B; another name is a channel's, or stands before .R, .G and .B of three channels. False
// where the file has none of this name; `error` has those that it has.
bool view_channel_find(struct view_channel *channel, int fd, const char *name, struct error *error);
void view_channel_finish(struct view_channel *channel);
