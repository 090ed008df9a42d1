// Which function answers which method: explain, plan, preview, frames_png, picture, header, verify, a chart's.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct json_writer;
struct request;
struct request_tools;

// True for a method that requests_answer knows.
bool requests_is_known(const char *method);
// Answers a request of a known method, however long that takes: appends one whole message to `reply`, a result or an
// error.
void requests_answer(const struct request *request, const struct request_tools *tools, struct json_writer *reply);
