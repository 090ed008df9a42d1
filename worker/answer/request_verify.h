// worker.verify: what files of a sequence hold, and what is wrong with each by itself.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/answer/request.h"

request_function request_answer_verify;
