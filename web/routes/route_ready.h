// GET /readyz: whether the daemon answers. One question to it is for all who ask within a second.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <uv.h>

struct farm_calls;
struct http_request;
struct route_ready;

struct route_ready *route_ready_create(uv_loop_t *loop, struct farm_calls *calls); // borrowed; outlive us
void route_ready_destroy(struct route_ready *route);                               // no request may be left

void route_ready_answer(struct http_request *request, void *user); // a route's answer; `user` is a struct route_ready
