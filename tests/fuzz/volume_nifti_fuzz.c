// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/volume_input.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    bool is_zipped = size > 0 && bytes[0] == 0x1f;
    struct volume_source source = {.path = volume_input_write(is_zipped ? "a.nii.gz" : "a.nii", bytes, size)};

    volume_input_try(&source);
    return 0;
}
