// What every program says to --version: its version, its commit, and the versions of its libraries, a line each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

// Twelve digits, and "-dirty" when files differed from it; empty where the tree has no history. A file that each build
// writes defines it, and only programs link that one.
extern const char version_commit[];

// "PROGRAM VERSION", "commit COMMIT", then the libraries of core/. A program adds those of its own as "NAME VERSION".
void version_print(FILE *out, const char *program);
