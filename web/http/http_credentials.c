// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_credentials.h"

#include "core/base/alloc.h"

#include <ctype.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool http_token_is_well_formed(const char *token)
{
    size_t length = 0;

    for (; token[length]; length++)
        if (length >= HTTP_TOKEN_LIMIT || (!isalnum((unsigned char)token[length]) && !strchr("-_.~", token[length])))
            return false;
    return length > 0;
}

static char *take(const char *text, size_t length)
{
    char *token = xstrndup(text, length);

    if (http_token_is_well_formed(token)) return token;
    http_credentials_free(token);
    return NULL;
}

char *http_credentials_from_header(const char *authorization)
{
    static const char scheme[] = "Bearer ";
    size_t length;

    if (strncasecmp(authorization, scheme, strlen(scheme)) != 0) return NULL;
    authorization += strlen(scheme);
    authorization += strspn(authorization, " ");
    length = strlen(authorization);
    while (length > 0 && authorization[length - 1] == ' ')
        length--;
    return take(authorization, length);
}

char *http_credentials_from_cookie(const char *cookies)
{
    static const char name[] = HTTP_COOKIE_NAME "=";
    const char *found = NULL;
    size_t found_length = 0;

    while (*cookies) {
        size_t length;

        cookies += strspn(cookies, "; \t");
        length = strcspn(cookies, ";");
        if (strncmp(cookies, name, strlen(name)) == 0) {
            size_t skipped = strlen(name);

            while (length > skipped && strchr(" \t", cookies[length - 1]))
                length--;
            if (found) return NULL;
            found = cookies + skipped;
            found_length = length - skipped;
        }
        cookies += strcspn(cookies, ";");
    }
    return found ? take(found, found_length) : NULL;
}

void http_credentials_free(char *token)
{
    if (token) explicit_bzero(token, strlen(token));
    free(token);
}
