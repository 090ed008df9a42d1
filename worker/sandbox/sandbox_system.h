// Allows what a fenced worker reads of the machine: libraries, GL drivers, their settings, devices, /proc and /sys.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct sandbox_landlock;

// `shader_folder` may be NULL.
bool sandbox_system_allow(const struct sandbox_landlock *landlock, const char *shader_folder, struct error *error);
// Allows nanovdb_convert, as found by $PATH, and what loads it.
bool sandbox_system_allow_converter(const struct sandbox_landlock *landlock, struct error *error);
