// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/volume_input.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct volume_source source = {.path = volume_input_write("a.nhdr", bytes, size)};

    volume_input_try(&source);
    return 0;
}
