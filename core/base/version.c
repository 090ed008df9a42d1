// SPDX-License-Identifier: Apache-2.0
#include "core/base/version.h"

#include <cjson/cJSON.h>
#include <xxhash.h>

void version_print(FILE *out, const char *program)
{
    unsigned xxhash = XXH_versionNumber();

    fprintf(out, "%s %s\ncommit %s\n", program, MARCHD_VERSION, version_commit[0] ? version_commit : "unknown");
    fprintf(out, "cJSON %s\nxxHash %u.%u.%u\n", cJSON_Version(), xxhash / 10000, xxhash / 100 % 100, xxhash % 100);
}
