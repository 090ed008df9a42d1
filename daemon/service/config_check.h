// Says what is there of what right settings name, without a daemon.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct options;

// Warns of folders, programs and groups that the settings name and that are not there. Nothing is made or changed.
void config_check_print(const struct options *options, FILE *out);
