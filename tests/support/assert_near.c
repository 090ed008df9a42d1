// SPDX-License-Identifier: Apache-2.0
#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

void assert_near_at(double actual, double wanted, double tolerance, const char *file, int line)
{
    if (fabs(actual - wanted) <= tolerance) return;
    print_error("%.17g is %.3g from %.17g, over %.3g\n", actual, fabs(actual - wanted), wanted, tolerance);
    _fail(file, line);
}
