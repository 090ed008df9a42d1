// Answers worker.picture and worker.header: a frame's file as a picture for people, and what its header says.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/answer/request.h"

request_function request_answer_picture;
request_function request_answer_header;
