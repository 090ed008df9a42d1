// A WebSocket: text messages each way, with limits on what waits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct http_socket;

// The status codes with which a socket is closed (RFC 6455, section 7.4.1).
enum http_socket_code {
    HTTP_SOCKET_GOING_AWAY = 1001,
    HTTP_SOCKET_NO_TEXT = 1003,
    HTTP_SOCKET_POLICY = 1008, // the token is not valid
    HTTP_SOCKET_TOO_BIG = 1009,
    HTTP_SOCKET_TRY_LATER = 1013 // the daemon is away, or too much waits
};

// All are called from the loop, none from within a function of this module.
struct http_socket_handlers {
    // `token` is borrowed. What it returns is given to the others.
    void *(*on_open)(void *user, struct http_socket *socket, const char *token);
    void (*on_message)(void *link, char *text, size_t length); // borrowed; may be changed
    void (*on_drained)(void *link);                            // what waited to be sent is less than a limit again
    void (*on_closed)(void *link);                             // the socket is freed afterwards
};

enum { HTTP_SOCKET_WAITING_LIMIT = 1024 * 1024 }; // bytes; above it, on_drained follows

// Whose it is, once the farm has taken its token: whose share of march-web it uses.
void http_socket_set_user(struct http_socket *socket, const char *user);
// The text is copied. Where too much waits already, it is dropped and the socket closed.
void http_socket_send(struct http_socket *socket, const char *text, size_t length);
// Bytes that wait beside the socket on its client's account, as those that are on their way to the daemon. They count
// like those that wait here: where that is too much, the socket is closed.
void http_socket_set_beside(struct http_socket *socket, size_t size_bytes);
bool http_socket_is_full(const struct http_socket *socket); // on_drained follows
// Stops and starts to read from the client.
void http_socket_pause(struct http_socket *socket, bool is_paused);
// What waits is sent before. on_closed follows.
void http_socket_close(struct http_socket *socket, enum http_socket_code code, const char *reason);
