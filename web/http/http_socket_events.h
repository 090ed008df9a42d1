// What libwebsockets tells a WebSocket of this room.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct http_connection;
struct http_socket;
struct http_socket_handlers;

struct http_socket *http_socket_create(struct http_connection *connection, const struct http_socket_handlers *handlers,
                                       void *user);
void http_socket_destroy(struct http_socket *socket); // calls on_closed; accepts NULL
// Each returns what its callback is to return: not 0 ends the connection.
int http_socket_on_established(struct http_socket *socket, const char *token);
int http_socket_on_receive(struct http_socket *socket, const char *bytes, size_t size);
int http_socket_on_writable(struct http_socket *socket);
