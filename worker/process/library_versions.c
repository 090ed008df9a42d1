// SPDX-License-Identifier: Apache-2.0
#include "worker/process/library_versions.h"

#include <OpenEXR/openexr.h>
#include <blosc.h>
#include <isa-l.h>
#include <libdeflate.h>
#include <png.h>
#include <seccomp.h>
#include <uv.h>
#include <zlib.h>

void library_versions_print(FILE *out)
{
    const struct scmp_version *seccomp = seccomp_version();
    int major, minor, patch;

    exr_get_library_version(&major, &minor, &patch, NULL);
    fprintf(out, "OpenEXR %d.%d.%d\n", major, minor, patch);
    // These two have no call that tells.
    fprintf(out, "libisal %d.%d.%d (compiled with)\n", ISAL_MAJOR_VERSION, ISAL_MINOR_VERSION, ISAL_PATCH_VERSION);
    fprintf(out, "libdeflate %s (compiled with)\n", LIBDEFLATE_VERSION_STRING);
    fprintf(out, "zlib %s\nlibpng %s\n", zlibVersion(), png_get_libpng_ver(NULL));
    fprintf(out, "Blosc %s\n", blosc_get_version_string());
    fprintf(out, "libseccomp %u.%u.%u\n", seccomp->major, seccomp->minor, seccomp->micro);
    fprintf(out, "libuv %s\n", uv_version_string());
}
