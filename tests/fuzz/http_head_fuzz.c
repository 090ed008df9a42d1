// Headers of strangers and of browsers: Host, Origin, Authorization and Cookie, one a line of the input.
// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_credentials.h"
#include "web/http/http_walls.h"

#include "core/base/alloc.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void require(bool condition)
{
    if (!condition) abort();
}

// A token is a piece of the header, and nothing that could end a header or an attribute.
static void check_token(char *token, const char *header)
{
    if (!token) return;
    require(http_token_is_well_formed(token) && strstr(header, token) && !strpbrk(token, "\"'<>;, \r\n\t"));
    http_credentials_free(token);
}

static void check_walls(const struct http_origins *origins, const char *host, const char *origin)
{
    bool is_ours = http_host_is_ours(origins, host);

    require(is_ours || !http_host_is_secure(origins, host));
    if (!http_origin_is_ours(origins, host, origin)) return;
    // The page that this very host serves, and no other.
    require(is_ours && strlen(origin) > strlen(host));
    require(strcasecmp(origin + strlen(origin) - strlen(host), host) == 0);
    require(strncasecmp(origin, "http", 4) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct http_origins origins = {0};
    char *text = xstrndup((const char *)bytes, size), *rest = text;
    const char *lines[5] = {"", "", "", "", ""};

    for (int i = 0; i < 5 && rest; i++)
        lines[i] = strsep(&rest, "\n");
    http_origins_add(&origins, "https://farm.example.org", NULL);
    if (http_origins_add(&origins, lines[4], NULL)) require(strncasecmp(lines[4], "http", 4) == 0);
    check_walls(&origins, lines[0], lines[1]);
    check_token(http_credentials_from_header(lines[2]), lines[2]);
    check_token(http_credentials_from_cookie(lines[3]), lines[3]);
    http_fetch_is_ours(lines[1]);
    http_origins_finish(&origins);
    free(text);
    return 0;
}
