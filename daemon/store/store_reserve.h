// The reserve: a file in the state folder that gives its room to the store when the disk is full.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

// Makes FOLDER/reserve, or fills up one that is there: 8 MiB, or an eighth of a smaller file system. False where the
// disk has no room for it, or none beside it for what is stored next. A file system that cannot set room aside has no
// reserve, which is no failure.
bool store_reserve_make(const char *folder, struct error *error);
bool store_reserve_release(const char *folder); // gives the room back to the disk; false: there was none
