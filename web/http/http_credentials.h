// Where a request carries its token: the header Authorization or our cookie.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

#define HTTP_COOKIE_NAME "marchd_session"

enum { HTTP_TOKEN_LIMIT = 256 }; // the longest text that can be a token, in bytes

// Letters, digits, '-', '_', '.' and '~'; not empty, within the limit.
bool http_token_is_well_formed(const char *token);
// The token of "Bearer TOKEN", or NULL. Owned by the caller.
char *http_credentials_from_header(const char *authorization);
// The token of our cookie in a header Cookie, or NULL: also where there are several, for one may be planted. Owned by
// the caller.
char *http_credentials_from_cookie(const char *cookies);
void http_credentials_free(char *token); // wipes it; accepts NULL
