// GET /frame/JOB/N.png, .json, /job/JOB/explain: the daemon says what is there, and a worker without rights reads it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

struct error;
struct farm_calls;
struct http_request;
struct route_frame;

struct route_frame_params {
    uv_loop_t *loop; // borrowed; outlives us, like the next one
    struct farm_calls *calls;
    const char *worker, *cache_folder; // borrowed for the call; the folder is made where it is missing
    int64_t cache_bytes, worker_bytes;
    int64_t limit_ms;
    int worker_count;
};

// Never NULL: where there can be no pictures, each request is answered with the reason, which is logged once.
struct route_frame *route_frame_open(const struct route_frame_params *params);
void route_frame_close(struct route_frame *route); // no request is left; frees itself in the loop

void route_frame_answer(struct http_request *request, void *user); // a route's answer; `user` is a struct route_frame
