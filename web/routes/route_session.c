// SPDX-License-Identifier: Apache-2.0
#include "web/routes/route_session.h"

#include "core/base/alloc.h"
#include "core/json/json_write.h"
#include "web/http/http_credentials.h"
#include "web/http/http_request.h"
#include "web/routes/route_files.h"
#include "web/routes/web_calls.h"

#include <stdio.h>
#include <string.h>

enum { SESSION_S = 12 * 3600 };

// "marchd_session=TOKEN; ...", owned by the caller. A life of 0 seconds drops it.
static char *make_cookie(const struct http_request *request, const char *token, int life_s)
{
    return xasprintf(HTTP_COOKIE_NAME "=%s; HttpOnly; SameSite=Strict; Path=/; Max-Age=%d%s", token, life_s,
                     http_request_is_secure(request) ? "; Secure" : "");
}

static void on_signed_in(struct http_request *request, const struct farm_answer *answer, void *user)
{
    const char *session = answer->identity->session;
    char *cookie;

    (void)user;
    // A token that lasts would stay in the browser's history and in logs of proxies.
    if (!session || !http_token_is_well_formed(session)) {
        http_request_fail(request, 403, "only a one-time token signs in by an address: march web");
        return;
    }
    cookie = make_cookie(request, session, SESSION_S);
    http_request_answer(request, &(struct http_answer){.status = 303, .location = "/", .cookie = cookie});
    http_credentials_free(cookie);
}

// Whoever leads a browser here by a link may want its user to work under another name: the user decides. `march web`
// leads here by a file.
static void ask_first(struct http_request *request, const char *token)
{
    char *page =
        xasprintf("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
                  "<meta name=\"viewport\" content=\"width=device-width\"><title>marchd</title>"
                  "<link rel=\"icon\" href=\"/page/icon.svg\"><link rel=\"stylesheet\" href=\"/page/page.css\">"
                  "</head><body><main><h1>marchd</h1><p>Did you ask for this by <code>march web</code>?</p>"
                  "<p><a id=\"sign-in\" href=\"/?token=%s\">Sign in to the farm</a></p></main></body></html>\n",
                  token);

    http_request_answer(
        request, &(struct http_answer){.type = "text/html; charset=utf-8", .bytes = page, .size_bytes = strlen(page)});
    http_credentials_free(page);
}

void route_session_front(struct http_request *request, void *user)
{
    const struct route_session *session = user;
    const char *token = http_request_query(request, "token");

    if (!token)
        route_files_front(request, session->files);
    else if (http_request_is_head(request))
        http_request_fail(request, 405, "a token is used by GET");
    else if (!http_token_is_well_formed(token))
        http_request_fail(request, 401, "this is no token");
    else if (http_request_is_from_elsewhere(request))
        ask_first(request, token);
    else
        web_calls_begin_as(session->calls, request, token, on_signed_in, NULL);
}

static void on_shown(struct http_request *request, const struct farm_answer *answer, void *user)
{
    const struct farm_identity *identity = answer->identity;
    struct json_writer writer = {0};

    (void)user;
    json_write_begin_object(&writer);
    json_write_string_member(&writer, "user", identity->user);
    json_write_string_member(&writer, "scope", identity->scope);
    json_write_key(&writer, "expires");
    if (identity->has_expiry)
        json_write_number(&writer, identity->expires);
    else
        json_write_null(&writer);
    json_write_end_object(&writer);
    http_request_answer(
        request, &(struct http_answer){.type = "application/json", .bytes = writer.text, .size_bytes = writer.length});
    json_writer_finish(&writer);
}

void route_session_show(struct http_request *request, void *user)
{
    const struct route_session *session = user;

    web_calls_begin_as(session->calls, request, http_request_token(request), on_shown, NULL);
}

void route_session_end(struct http_request *request, void *user)
{
    char *cookie = make_cookie(request, "", 0);

    (void)user;
    http_request_answer(request, &(struct http_answer){.status = 204, .cookie = cookie});
    http_credentials_free(cookie);
}
