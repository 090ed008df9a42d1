// POST /rpc: one JSON-RPC message, and the daemon's answer as it is.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct http_request;

void route_rpc(struct http_request *request, void *user); // `user` is a struct farm_calls
