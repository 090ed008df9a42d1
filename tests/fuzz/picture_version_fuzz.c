// Headers of pictures that lie in an output folder, as the daemon reads them.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/picture_version.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct picture_version version;

    if (picture_version_parse(&version, bytes, size) != (version.hash[0] != '\0')) abort();
    if (strnlen(version.hash, HASH_TEXT_SIZE) == HASH_TEXT_SIZE) abort();
    return 0;
}
