// Answers worker.verify: what each file of a sequence holds, and what is wrong with it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/answer/request.h"

request_function request_answer_verify;
