// Compares doubles as doubles: cmocka's assert_float_equal rounds its arguments to float first.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Fails the test unless |actual - wanted| <= tolerance; a NaN fails.
#define assert_near(actual, wanted, tolerance) assert_near_at(actual, wanted, tolerance, __FILE__, __LINE__)

void assert_near_at(double actual, double wanted, double tolerance, const char *file, int line);
