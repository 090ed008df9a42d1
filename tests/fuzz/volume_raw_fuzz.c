// The keys of a raw file, its name and its bytes: nine bytes of keys, the name to the end of the line, the voxels.
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/volume_input.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { KEY_BYTES = 9, NAME_LIMIT = 100 };

// Keys as a job may have them: a size of 0 stands for that in the name; no number is negative.
static void take_keys(struct volume_source *source, const uint8_t *bytes)
{
    for (int axis = 0; axis < 3; axis++) {
        source->raw.size[axis] = bytes[axis];
        source->spacing[axis] = bytes[3 + axis] / 16.0;
    }
    source->raw.type = bytes[6] % 4;
    source->raw.has_type = bytes[6] & 8;
    source->raw.is_big_endian = bytes[7] & 1;
    source->raw.skip_bytes = bytes[8];
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct volume_source source = {0};
    char name[NAME_LIMIT + 6] = "n";
    size_t length = 1;

    if (size < KEY_BYTES) return 0;
    take_keys(&source, bytes);
    bytes += KEY_BYTES, size -= KEY_BYTES;
    for (; size > 0 && *bytes != '\n'; bytes++, size--)
        if (length < NAME_LIMIT && *bytes != '/' && *bytes != '\0') name[length++] = (char)*bytes;
    if (size > 0) bytes++, size--;
    strcat(name, ".raw");
    source.path = volume_input_write(name, bytes, size);
    volume_input_try(&source);
    return 0;
}
