// A text that is sent to several clients and kept once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct json_writer;

// Freed when its last holder releases it.
struct shared_text {
    char *bytes; // owned
    size_t length;
    size_t holders;
};

struct shared_text *shared_text_create(struct json_writer *writer); // takes the writer's text; the caller holds it
struct shared_text *shared_text_hold(struct shared_text *text);     // one holder more
void shared_text_release(struct shared_text *text);                 // accepts NULL
