// Versions of the libraries that the daemon runs with.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

void library_versions_print(FILE *out); // a line "NAME VERSION" for each
