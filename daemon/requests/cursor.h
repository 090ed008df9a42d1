// Text that says where the next page of a list begins. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum { CURSOR_TEXT_SIZE = 24 };

// Which list a cursor belongs to; the others refuse it.
enum cursor_list { CURSOR_JOBS_UP = 'u', CURSOR_JOBS_DOWN = 'd', CURSOR_FRAMES = 'f' };

// `position` is not negative.
void cursor_format(char text[static CURSOR_TEXT_SIZE], enum cursor_list list, int64_t position);
bool cursor_parse(const char *text, enum cursor_list list, int64_t *position); // false: it is no cursor of that list
