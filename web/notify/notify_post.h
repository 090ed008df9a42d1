// Sends notices to webhooks: libcurl, with the walls that a stranger's address needs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "web/notify/notify_outcome.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct notify_posts;

struct notify_post_params {
    const char *url;
    const char *secret; // NULL: nothing is signed
    size_t secret_size;
    bool may_be_private;
    int64_t timeout_ms;
    struct notify_line *line; // whose first item is sent; borrowed until the end
};

void notify_posts_prepare(void); // to be called first, and before other threads are started
struct notify_posts *notify_posts_create(notify_on_end *on_end, void *user); // borrowed
void notify_posts_destroy(struct notify_posts *posts); // those under way end without on_end; accepts NULL
// No redirect is followed, no proxy asked and no connection used twice. Where the target may not be private, an address
// is looked at when it is about to be connected to, so that its name cannot mean another one then.
void notify_posts_begin(struct notify_posts *posts, const struct notify_post_params *params);
// Goes on with all of them until one of `fds` can be read, something else happens, or the time is over.
void notify_posts_wait(struct notify_posts *posts, const int *fds, size_t fd_count, int timeout_ms);
