// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_walls.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const char plain[] = "http://", secure[] = "https://";

// The part after the scheme; NULL: another scheme.
static const char *host_of(const char *origin)
{
    if (strncasecmp(origin, plain, strlen(plain)) == 0) return origin + strlen(plain);
    if (strncasecmp(origin, secure, strlen(secure)) == 0) return origin + strlen(secure);
    return NULL;
}

static bool is_port(const char *text)
{
    size_t length = strspn(text, "0123456789");

    return length >= 1 && length <= 5 && !text[length];
}

static bool is_loopback(const char *host)
{
    static const char *const names[] = {"localhost", "127.0.0.1", "[::1]"};

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        size_t length = strlen(names[i]);

        if (strncasecmp(host, names[i], length) != 0) continue;
        if (!host[length] || (host[length] == ':' && is_port(host + length + 1))) return true;
    }
    return false;
}

// Over http browsers do not say whether another site made them ask (Sec-Fetch-Site), and whoever is on the way reads
// and changes what passes.
static bool is_plain_and_far(const char *origin)
{
    return strncasecmp(origin, plain, strlen(plain)) == 0 && !is_loopback(host_of(origin));
}

bool http_origins_add(struct http_origins *origins, const char *text, struct error *error)
{
    const char *host = host_of(text), *end;
    size_t length;

    if (host && is_plain_and_far(text)) {
        error_set(error,
                  "--origin: expected https://..., got \"%s\": http is for this machine's own names alone (localhost, "
                  "127.0.0.1, [::1])",
                  text);
        return false;
    }
    if (host) {
        length = *host == '[' ? 1 + strspn(host + 1, "0123456789abcdefABCDEF:.") : strcspn(host, ":/");
        if (*host == '[' && host[length] == ']') length++;
        end = host + length;
        for (const char *at = host; at < end; at++)
            if (!isalnum((unsigned char)*at) && !strchr("-._[]:", *at)) length = 0;
        if (length > 0 && (!*end || (*end == ':' && is_port(end + 1)))) {
            origins->texts = xgrow(origins->texts, &origins->capacity, origins->count + 1, sizeof origins->texts[0]);
            origins->texts[origins->count++] = xstrdup(text);
            return true;
        }
    }
    error_set(error, "--origin: expected https://HOST or https://HOST:PORT, got \"%s\"", text);
    return false;
}

void http_origins_finish(struct http_origins *origins)
{
    for (size_t i = 0; i < origins->count; i++)
        free(origins->texts[i]);
    free(origins->texts);
    *origins = (struct http_origins){0};
}

static const char *find_origin(const struct http_origins *origins, const char *host)
{
    for (size_t i = 0; i < origins->count; i++)
        if (strcasecmp(host_of(origins->texts[i]), host) == 0) return origins->texts[i];
    return NULL;
}

bool http_origins_have_secure(const struct http_origins *origins)
{
    for (size_t i = 0; i < origins->count; i++)
        if (strncasecmp(origins->texts[i], secure, strlen(secure)) == 0) return true;
    return false;
}

bool http_host_is_ours(const struct http_origins *origins, const char *host)
{
    return is_loopback(host) || find_origin(origins, host);
}

bool http_host_is_secure(const struct http_origins *origins, const char *host)
{
    const char *origin = find_origin(origins, host);

    return origin && strncasecmp(origin, secure, strlen(secure)) == 0;
}

bool http_origin_is_ours(const struct http_origins *origins, const char *host, const char *origin)
{
    const char *known = find_origin(origins, host), *its = host_of(origin);

    if (known) return strcasecmp(known, origin) == 0;
    return its && strncasecmp(origin, plain, strlen(plain)) == 0 && is_loopback(host) && strcasecmp(its, host) == 0;
}

bool http_fetch_is_ours(const char *fetch_site)
{
    return !fetch_site || strcmp(fetch_site, "same-origin") == 0 || strcmp(fetch_site, "none") == 0;
}
