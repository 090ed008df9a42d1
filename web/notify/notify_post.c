// SPDX-License-Identifier: Apache-2.0
#include "web/notify/notify_post.h"

#include "core/base/alloc.h"
#include "core/base/version.h"
#include "web/notify/notify_address.h"
#include "web/notify/notify_hmac.h"
#include "web/notify/notify_queue.h"

#include <curl/curl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FD_LIMIT = 160, CONNECT_MS = 10 * 1000, REPLY_LIMIT = 64 * 1024, WHY_SIZE = 200 };

struct notify_posts {
    CURLM *multi; // owned
    notify_on_end *on_end;
    void *user;
    struct post *first; // list of those under way
};

struct post {
    CURL *easy;                 // owned
    struct curl_slist *headers; // owned
    char text[CURL_ERROR_SIZE]; // curl's error
    bool may_be_private;
    bool is_refused, is_tried; // some address of it
    size_t reply_size;
    struct notify_line *line; // borrowed
    struct post *next;
};

static curl_socket_t on_open_socket(void *user, curlsocktype purpose, struct curl_sockaddr *address);
static size_t on_reply(char *bytes, size_t size, size_t count, void *user);

void notify_posts_prepare(void)
{
    if (curl_global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK) abort();
}

struct notify_posts *notify_posts_create(notify_on_end *on_end, void *user)
{
    struct notify_posts *posts = xcalloc(1, sizeof *posts);

    posts->multi = curl_multi_init();
    if (!posts->multi) abort();
    curl_multi_setopt(posts->multi, CURLMOPT_PIPELINING, CURLPIPE_NOTHING);
    posts->on_end = on_end;
    posts->user = user;
    return posts;
}

static void post_destroy(struct notify_posts *posts, struct post *post)
{
    for (struct post **link = &posts->first; *link; link = &(*link)->next) {
        if (*link != post) continue;
        *link = post->next;
        break;
    }
    curl_multi_remove_handle(posts->multi, post->easy);
    curl_easy_cleanup(post->easy);
    curl_slist_free_all(post->headers);
    free(post);
}

void notify_posts_destroy(struct notify_posts *posts)
{
    if (!posts) return;
    while (posts->first)
        post_destroy(posts, posts->first);
    curl_multi_cleanup(posts->multi);
    free(posts);
}

static void add_header(struct post *post, const char *name, const char *value)
{
    char *line = xasprintf("%s: %s", name, value);
    struct curl_slist *headers = curl_slist_append(post->headers, line);

    if (!headers) abort();
    post->headers = headers;
    free(line);
}

// The signature covers the time, so that what is sent later is known to be old.
static void add_headers(struct post *post, const struct notify_post_params *params)
{
    char id[24], seconds[24], signature[NOTIFY_HMAC_SIZE];
    const struct notify_bytes secret = {params->secret, params->secret_size};
    struct notify_bytes parts[3];
    char *value;

    snprintf(id, sizeof id, "%" PRId64, params->line->items[0].id);
    snprintf(seconds, sizeof seconds, "%lld", (long long)time(NULL));
    add_header(post, "Content-Type", "application/json");
    add_header(post, "Expect", "");
    add_header(post, "User-Agent", "march-web/" MARCHD_VERSION);
    add_header(post, "X-Marchd-Event", params->line->items[0].event);
    add_header(post, "X-Marchd-Id", id);
    add_header(post, "X-Marchd-Timestamp", seconds);
    if (!params->secret) return;
    parts[0] = (struct notify_bytes){seconds, strlen(seconds)};
    parts[1] = (struct notify_bytes){".", 1};
    parts[2] = (struct notify_bytes){params->line->items[0].body, strlen(params->line->items[0].body)};
    notify_hmac(&secret, parts, 3, signature);
    value = xasprintf("sha256=%s", signature);
    add_header(post, "X-Marchd-Signature", value);
    free(value);
}

static void set_options(struct post *post, const struct notify_post_params *params)
{
    CURL *easy = post->easy;
    bool ok = curl_easy_setopt(easy, CURLOPT_URL, params->url) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "http,https") == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_FOLLOWLOCATION, 0L) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_PROXY, "") == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_NETRC, (long)CURL_NETRC_IGNORED) == CURLE_OK &&
              // A connection that another target opened was checked for that one alone.
              curl_easy_setopt(easy, CURLOPT_FRESH_CONNECT, 1L) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_FORBID_REUSE, 1L) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_OPENSOCKETFUNCTION, on_open_socket) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_OPENSOCKETDATA, post) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_reply) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_WRITEDATA, post) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_ERRORBUFFER, post->text) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_PRIVATE, post) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT_MS, (long)CONNECT_MS) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_TIMEOUT_MS, (long)params->timeout_ms) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_POST, 1L) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_POSTFIELDSIZE, (long)strlen(params->line->items[0].body)) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_COPYPOSTFIELDS, params->line->items[0].body) == CURLE_OK &&
              curl_easy_setopt(easy, CURLOPT_HTTPHEADER, post->headers) == CURLE_OK;

    if (!ok) abort(); // memory, or a curl without a wall
}

void notify_posts_begin(struct notify_posts *posts, const struct notify_post_params *params)
{
    struct post *post = xcalloc(1, sizeof *post);

    post->easy = curl_easy_init();
    if (!post->easy) abort();
    post->may_be_private = params->may_be_private;
    post->line = params->line;
    add_headers(post, params);
    set_options(post, params);
    post->next = posts->first;
    posts->first = post;
    curl_multi_add_handle(posts->multi, post->easy);
}

static curl_socket_t on_open_socket(void *user, curlsocktype purpose, struct curl_sockaddr *address)
{
    struct post *post = user;

    if (purpose == CURLSOCKTYPE_IPCXN && (post->may_be_private || (notify_address_is_public(&address->addr) &&
                                                                   !notify_address_is_own(&address->addr)))) {
        post->is_tried = true;
        return socket(address->family, address->socktype | SOCK_CLOEXEC, address->protocol);
    }
    post->is_refused = true;
    return CURL_SOCKET_BAD;
}

// What a webhook answers is its status; the rest is read up to a limit, and no longer once it has taken the notice.
static size_t on_reply(char *bytes, size_t size, size_t count, void *user)
{
    struct post *post = user;
    long status = 0;

    (void)bytes;
    curl_easy_getinfo(post->easy, CURLINFO_RESPONSE_CODE, &status);
    post->reply_size += size * count;
    return status / 100 == 2 || post->reply_size > REPLY_LIMIT ? 0 : size * count;
}

static enum notify_outcome judge(const struct post *post, CURLcode result, char why[static WHY_SIZE])
{
    long status = 0;

    curl_easy_getinfo(post->easy, CURLINFO_RESPONSE_CODE, &status);
    if (status / 100 == 2) return NOTIFY_DELIVERED;
    if (post->is_refused && !post->is_tried && status == 0) {
        snprintf(why, WHY_SIZE, "its address is of this machine or of a private network");
        return NOTIFY_HOPELESS;
    }
    if (status > 0)
        snprintf(why, WHY_SIZE, "it answers %ld%s", status,
                 status / 100 == 3 ? ", and redirects are not followed" : "");
    else
        snprintf(why, WHY_SIZE, "%.*s", WHY_SIZE - 1, *post->text ? post->text : curl_easy_strerror(result));
    return status == 410 ? NOTIFY_HOPELESS : NOTIFY_FAILED;
}

static void end_posts(struct notify_posts *posts)
{
    CURLMsg *message;
    int left;

    while ((message = curl_multi_info_read(posts->multi, &left))) {
        enum notify_outcome outcome;
        struct post *post;
        char why[WHY_SIZE] = "";
        struct notify_line *line;

        if (message->msg != CURLMSG_DONE) continue;
        curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, (char **)&post);
        outcome = judge(post, message->data.result, why);
        line = post->line;
        post_destroy(posts, post);
        posts->on_end(posts->user, line, outcome, outcome == NOTIFY_DELIVERED ? NULL : why);
    }
}

void notify_posts_wait(struct notify_posts *posts, const int *fds, size_t fd_count, int timeout_ms)
{
    struct curl_waitfd waits[FD_LIMIT];
    int running;

    if (fd_count > FD_LIMIT) fd_count = FD_LIMIT;
    for (size_t i = 0; i < fd_count; i++)
        waits[i] = (struct curl_waitfd){.fd = fds[i], .events = CURL_WAIT_POLLIN};
    curl_multi_perform(posts->multi, &running);
    end_posts(posts);
    curl_multi_poll(posts->multi, waits, (unsigned)fd_count, timeout_ms, NULL);
    curl_multi_perform(posts->multi, &running);
    end_posts(posts);
}
