// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_intake.h"

#include "core/base/alloc.h"
#include "web/http/http_connection.h"
#include "web/http/http_credentials.h"
#include "web/http/http_request.h"
#include "web/http/http_walls.h"

#include <stdlib.h>
#include <string.h>

static const struct http_refusal none = {0};

// NULL: there is no such header. Owned by the caller.
static char *copy_header(struct lws *wsi, enum lws_token_indexes header)
{
    int length = lws_hdr_total_length(wsi, header);
    char *text;

    if (length <= 0) return NULL;
    text = xmalloc((size_t)length + 1);
    if (lws_hdr_copy(wsi, text, length + 1, header) >= 0) return text;
    free(text);
    return NULL;
}

// `name` in lower case, with its colon.
static char *copy_custom_header(struct lws *wsi, const char *name)
{
    int length = lws_hdr_custom_length(wsi, name, (int)strlen(name));
    char *text;

    if (length < 0) return NULL;
    text = xmalloc((size_t)length + 1);
    if (lws_hdr_custom_copy(wsi, text, length + 1, name, (int)strlen(name)) >= 0) return text;
    free(text);
    return NULL;
}

// Servers before us may read another one of two than we do.
static bool is_there_twice(struct lws *wsi)
{
    static const enum lws_token_indexes single[] = {WSI_TOKEN_HOST, WSI_TOKEN_HTTP_CONTENT_LENGTH, WSI_TOKEN_ORIGIN,
                                                    WSI_TOKEN_HTTP_AUTHORIZATION, WSI_TOKEN_UPGRADE};

    for (size_t i = 0; i < sizeof single / sizeof single[0]; i++)
        if (lws_hdr_fragment_length(wsi, single[i], 1) > 0) return true;
    return false;
}

// libwebsockets takes a blank before the colon for a part of a name that it does not know (RFC 9112, section 5.1, wants
// it refused); another server may read these two all the same.
static bool has_odd_name(struct lws *wsi)
{
    static const char *const names[] = {
        "transfer-encoding :", "transfer-encoding\t:", "content-length :", "content-length\t:"};

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (lws_hdr_custom_length(wsi, names[i], (int)strlen(names[i])) >= 0) return true;
    return false;
}

static struct http_refusal read_length(struct http_request *request, struct lws *wsi)
{
    char *text = copy_header(wsi, WSI_TOKEN_HTTP_CONTENT_LENGTH);
    size_t digits = text ? strspn(text, "0123456789") : 0;
    bool is_right = !text || (digits > 0 && digits < 16 && !text[digits]);

    request->body_length = text && is_right ? strtoull(text, NULL, 10) : 0;
    if (!text && strcmp(request->method, "POST") == 0) return (struct http_refusal){411, "expected a Content-Length"};
    free(text);
    if (!is_right) return (struct http_refusal){400, "Content-Length: expected a whole number"};
    if (request->body_length > 0 && strcmp(request->method, "POST") != 0)
        return (struct http_refusal){400, "expected no body"};
    return none;
}

static struct http_refusal read_queries(struct http_request *request, struct lws *wsi)
{
    int length;

    for (int i = 0; (length = lws_hdr_fragment_length(wsi, WSI_TOKEN_HTTP_URI_ARGS, i)) > 0; i++) {
        char *text;

        if (request->query_count == HTTP_QUERY_LIMIT)
            return (struct http_refusal){400, "the address has too many parameters"};
        text = xmalloc((size_t)length + 1);
        if (lws_hdr_copy_fragment(wsi, text, length + 1, WSI_TOKEN_HTTP_URI_ARGS, i) < 0) text[0] = '\0';
        request->queries[request->query_count++] = text;
    }
    return none;
}

static bool read_method(struct http_request *request, struct lws *wsi)
{
    static const struct {
        enum lws_token_indexes header;
        const char *method;
    } methods[] = {{WSI_TOKEN_GET_URI, "GET"}, {WSI_TOKEN_POST_URI, "POST"}, {WSI_TOKEN_HEAD_URI, "HEAD"}};

    strcpy(request->method, "OTHER");
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
        char *path = copy_header(wsi, methods[i].header);

        if (!path) continue;
        strcpy(request->method, methods[i].method);
        request->path = path;
        return true;
    }
    request->path = xstrdup("");
    return false;
}

static void read_token(struct http_request *request, struct lws *wsi)
{
    char *authorization = copy_header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION);
    char *cookies = copy_header(wsi, WSI_TOKEN_HTTP_COOKIE);

    if (authorization)
        request->token = http_credentials_from_header(authorization);
    else if (cookies) {
        request->token = http_credentials_from_cookie(cookies);
        request->is_by_cookie = request->token != NULL;
    }
    http_credentials_free(authorization);
    http_credentials_free(cookies);
}

static struct http_refusal read_head(struct http_request *request, struct lws *wsi, const struct http_origins *origins)
{
    request->host = copy_header(wsi, WSI_TOKEN_HOST);
    request->origin = copy_header(wsi, WSI_TOKEN_ORIGIN);
    request->fetch_site = copy_custom_header(wsi, "sec-fetch-site:");
    request->known_etag = copy_header(wsi, WSI_TOKEN_HTTP_IF_NONE_MATCH);
    if (!read_method(request, wsi)) return (struct http_refusal){405, "expected GET, HEAD or POST"};
    if (has_odd_name(wsi)) return (struct http_refusal){400, "a header's name ends with a blank"};
    if (is_there_twice(wsi)) return (struct http_refusal){400, "a header is there twice"};
    if (lws_hdr_total_length(wsi, WSI_TOKEN_HTTP_TRANSFER_ENCODING) > 0)
        return (struct http_refusal){501, "Transfer-Encoding: expected a Content-Length in place of it"};
    if (!request->host || !http_host_is_ours(origins, request->host))
        return (struct http_refusal){421,
                                     "Host: this is no name of this server; --origin of march-web names further ones"};
    if (request->origin && !http_origin_is_ours(origins, request->host, request->origin))
        return (struct http_refusal){403, "Origin: another site's pages may not ask here"};
    request->is_secure = http_host_is_secure(origins, request->host);
    read_token(request, wsi);
    return read_queries(request, wsi);
}

struct http_refusal http_intake_read(struct http_request *request, struct lws *wsi, const struct http_origins *origins)
{
    struct http_refusal refusal = read_head(request, wsi, origins);
    bool is_front = strcmp(request->path, "/") == 0 && strcmp(request->method, "POST") != 0;
    bool is_sign_in = is_front && http_request_query(request, "token");

    if (!refusal.status) refusal = read_length(request, wsi);
    if (refusal.status) return refusal;
    // A link on another site may lead to the page, which holds nothing, and to a sign-in, which then asks first.
    if (!http_fetch_is_ours(request->fetch_site) && (!is_front || (request->query_count > 0 && !is_sign_in)))
        return (struct http_refusal){403, "Sec-Fetch-Site: another site's pages may not ask here"};
    if (!is_front && http_request_query(request, "token"))
        return (struct http_refusal){400, "a token is taken from the header Authorization, never from an address"};
    // A browser says at least one of both with what changes something.
    if (request->is_by_cookie && strcmp(request->method, "POST") == 0 && !request->origin && !request->fetch_site)
        return (struct http_refusal){403, "expected Origin or Sec-Fetch-Site beside a cookie"};
    return none;
}

struct http_refusal http_intake_read_upgrade(struct http_request *request, struct lws *wsi,
                                             const struct http_origins *origins)
{
    struct http_refusal refusal = read_head(request, wsi, origins);
    char *protocol;
    bool is_known;

    if (refusal.status) return refusal;
    protocol = copy_header(wsi, WSI_TOKEN_PROTOCOL);
    is_known = protocol && strcmp(protocol, "marchd") == 0;
    free(protocol);
    if (strcmp(request->method, "GET") != 0 || strcmp(request->path, "/ws") != 0)
        return (struct http_refusal){404, "there is a WebSocket at /ws alone"};
    if (!is_known) return (struct http_refusal){400, "Sec-WebSocket-Protocol: expected marchd"};
    if (request->query_count > 0) return (struct http_refusal){400, "the address of the WebSocket has no parameters"};
    if (!request->token) return (struct http_refusal){401, "expected a token or a session's cookie"};
    if (request->is_by_cookie && !request->origin) return (struct http_refusal){403, "expected Origin beside a cookie"};
    return none;
}
