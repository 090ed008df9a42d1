// Answers the requests that a chart is made from: extent, truth, time and error, strip. docs/protocol.md defines them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/answer/request.h"

request_function measure_answer_reach, measure_answer_truth, measure_answer_setting, measure_answer_strip;
