// Who is signed in, signing in with a one-time token, and out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct farm_calls;
struct http_request;
struct route_files;

// Borrowed.
struct route_session {
    struct farm_calls *calls;
    struct route_files *files;
};

// Each is a route's answer; `user` is a struct route_session.
void route_session_front(struct http_request *request, void *user); // GET /: the page, or with ?token= signs in
void route_session_show(struct http_request *request, void *user);  // GET /session
void route_session_end(struct http_request *request, void *user);   // POST /logout
