// A listening TCP socket on one address.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

struct error;
struct http_listener;
struct http_peer;

struct http_listener_params {
    uv_loop_t *loop;     // borrowed; outlives us
    const char *address; // "127.0.0.1:8470" or "[::1]:8470"; port 0: any that is free
    // Called with a connection, which it owns from then on.
    void (*on_connection)(void *user, int fd, const struct http_peer *peer);
    void *user;
};

bool http_address_check(const char *address, struct error *error);
bool http_address_is_loopback(const char *address); // of one that is right

struct http_listener *http_listener_open(const struct http_listener_params *params, struct error *error);
int http_listener_port(const struct http_listener *listener);
void http_listener_close(struct http_listener *listener); // frees itself in the loop; accepts NULL
