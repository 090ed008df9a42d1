// Answers worker.unseen: which volumes from files no frame shows, as far as a few frames tell.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/answer/request.h"

request_function unseen_answer;
