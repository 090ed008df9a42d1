// Lets a test run with shader modules broken on purpose.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdlib.h>

// The folder of MARCHD_TEST_SHADER_DIR, whose modules override the embedded ones; NULL without it.
static inline const char *test_shader_dir(void)
{
    return getenv("MARCHD_TEST_SHADER_DIR");
}
