// SPDX-License-Identifier: Apache-2.0
#include "web/routes/route_ready.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "web/farm/farm_calls.h"
#include "web/http/http_request.h"

#include <stdlib.h>

enum { KEPT_MS = 1000 };

// A request that waits for the daemon's answer.
struct waiting {
    struct route_ready *route; // borrowed
    struct http_request *request;
    struct waiting *next; // on the route's list
};

struct route_ready {
    uv_loop_t *loop;          // borrowed
    struct farm_calls *calls; // borrowed
    struct farm_call *call;   // NULL: nothing is asked now
    struct waiting *first;    // owned
    uint64_t kept_until_ms;   // of the loop's clock: until then the last answer holds
    enum farm_end end;        // that answer
    struct error why;
};

static void on_answer(void *user, const struct farm_answer *answer);

struct route_ready *route_ready_create(uv_loop_t *loop, struct farm_calls *calls)
{
    struct route_ready *route = xcalloc(1, sizeof *route);

    route->loop = loop;
    route->calls = calls;
    return route;
}

void route_ready_destroy(struct route_ready *route)
{
    free(route);
}

static void answer(const struct route_ready *route, struct http_request *request)
{
    static const struct http_answer there = {.type = "text/plain; charset=utf-8", .bytes = "ok\n", .size_bytes = 3};

    if (route->end == FARM_OPEN)
        http_request_answer(request, &there);
    else
        http_request_fail(request, route->end == FARM_FAULT ? 502 : 503, "the daemon: %s", route->why.message);
}

static void on_gone(void *user)
{
    struct waiting *waiting = user, **at = &waiting->route->first;
    struct route_ready *route = waiting->route;

    while (*at != waiting)
        at = &(*at)->next;
    *at = waiting->next;
    free(waiting);
    if (route->first) return;
    farm_call_cancel(route->call);
    route->call = NULL;
}

static void on_answer(void *user, const struct farm_answer *said)
{
    struct route_ready *route = user;

    route->call = NULL;
    route->end = said->end;
    error_set(&route->why, "%s", said->end == FARM_OPEN ? "" : said->why);
    route->kept_until_ms = uv_now(route->loop) + KEPT_MS;
    while (route->first) {
        struct waiting *waiting = route->first;

        route->first = waiting->next;
        http_request_on_gone(waiting->request, NULL, NULL);
        answer(route, waiting->request);
        free(waiting);
    }
}

void route_ready_answer(struct http_request *request, void *user)
{
    struct route_ready *route = user;
    struct waiting *waiting;

    if (uv_now(route->loop) < route->kept_until_ms) {
        answer(route, request);
        return;
    }
    waiting = xmalloc(sizeof *waiting);
    *waiting = (struct waiting){.route = route, .request = request, .next = route->first};
    route->first = waiting;
    http_request_on_gone(request, on_gone, waiting);
    if (!route->call) route->call = farm_calls_begin(route->calls, NULL, NULL, 0, on_answer, route);
}
