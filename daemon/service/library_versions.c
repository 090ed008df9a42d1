// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/library_versions.h"

#include <sqlite3.h>
#include <uv.h>

void library_versions_print(FILE *out)
{
    fprintf(out, "libuv %s\nSQLite %s\n", uv_version_string(), sqlite3_libversion());
    // These have no call that tells.
    fprintf(out, "libsystemd %s (compiled with)\nlibmd %s (compiled with)\n", SYSTEMD_VERSION, MD_VERSION);
}
