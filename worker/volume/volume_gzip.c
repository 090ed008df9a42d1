// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume_gzip.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <limits.h>
#include <stdlib.h>
#include <zlib.h>

// A window of 32 KiB; 16 stands for gzip's header instead of zlib's.
enum { WINDOW_BITS = 15 + 16 };

struct volume_gzip {
    z_stream zlib;
    bool is_complete;
    bool has_member; // one member has ended
};

struct volume_gzip *volume_gzip_create(void)
{
    struct volume_gzip *gzip = xcalloc(1, sizeof *gzip);

    gzip->is_complete = true;
    // Only a lack of memory, 40 KiB, makes it fail.
    if (inflateInit2(&gzip->zlib, WINDOW_BITS) != Z_OK) abort();
    return gzip;
}

void volume_gzip_destroy(struct volume_gzip *gzip)
{
    if (!gzip) return;
    inflateEnd(&gzip->zlib);
    free(gzip);
}

bool volume_gzip_is_complete(const struct volume_gzip *gzip)
{
    return gzip->is_complete;
}

static unsigned int limit_size(size_t size)
{
    return size < UINT_MAX ? (unsigned int)size : UINT_MAX;
}

bool volume_gzip_inflate(struct volume_gzip *gzip, const unsigned char *in, size_t *in_size, unsigned char *out,
                         size_t *out_size, struct error *error)
{
    z_stream *zlib = &gzip->zlib;
    int result;

    if (gzip->is_complete && *in_size > 0) {
        inflateReset(zlib);
        gzip->is_complete = false;
    }
    zlib->next_in = (unsigned char *)in;
    zlib->avail_in = limit_size(*in_size);
    zlib->next_out = out;
    zlib->avail_out = limit_size(*out_size);
    result = inflate(zlib, Z_NO_FLUSH);
    *in_size = (size_t)(zlib->next_in - in);
    *out_size = (size_t)(zlib->next_out - out);
    if (result == Z_STREAM_END) gzip->is_complete = gzip->has_member = true;
    if (result == Z_OK || result == Z_STREAM_END || result == Z_BUF_ERROR) return true;
    if (gzip->has_member)
        error_set(error, "expected its end or more gzip data behind the first, got something else");
    else
        error_set(error, "no gzip data, or damaged (%s)", zlib->msg ? zlib->msg : "out of memory");
    return false;
}
