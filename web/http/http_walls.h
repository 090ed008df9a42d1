// Which requests a browser may have been tricked into: decisions about the headers Host, Origin and Sec-Fetch-Site.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;

// Web origins beside those of the machine itself: "https://farm.example.org", where a proxy serves us.
struct http_origins {
    char **texts; // owned; without a slash at the end
    size_t count, capacity;
};

// Takes "https://HOST[:PORT]", and "http://HOST[:PORT]" where the host is this machine by its own name.
bool http_origins_add(struct http_origins *origins, const char *text, struct error *error);
void http_origins_finish(struct http_origins *origins);
bool http_origins_have_secure(const struct http_origins *origins); // true where one begins with https

// True of a Host that is this machine's by a name that no name server decides on (localhost, 127.0.0.1, [::1], any
// port, for a tunnel may have another), or that of an origin. Any other is a page whose name was pointed at us.
bool http_host_is_ours(const struct http_origins *origins, const char *host);
// True of the Host of an origin that begins with https: cookies are to be sent over TLS alone.
bool http_host_is_secure(const struct http_origins *origins, const char *host);
// True where `origin` is the page that this very Host serves, by the same scheme.
bool http_origin_is_ours(const struct http_origins *origins, const char *host, const char *origin);
// True where Sec-Fetch-Site says, if it is there (else NULL), that no other site has made the browser ask.
bool http_fetch_is_ours(const char *fetch_site);
