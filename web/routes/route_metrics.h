// GET /metrics: what the daemon counts, as text that Prometheus reads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct http_request;

void route_metrics(struct http_request *request, void *user); // `user` is a struct farm_calls
