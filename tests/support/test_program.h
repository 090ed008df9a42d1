// Tests of a folder are one program, which is linked once: it runs the test by whose name it is called.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct test_program {
    const char *name;               // FOLDER_NAME, as the links to the program are called
    int (*run)(void);               // the test's main, or NULL: then the next
    int (*run_with)(int, char *[]); // a main that takes arguments
};

// What tests/collect found.
extern const struct test_program test_programs[];
extern const size_t test_program_count;
