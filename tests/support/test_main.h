// Stands before every test: its main gets the name TEST_MAIN, which is its own in the program of its folder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#define main(...)                                                                                                      \
    TEST_MAIN(__VA_ARGS__);                                                                                            \
    int TEST_MAIN(__VA_ARGS__)
