// Questions about speed and accuracy that a chart is made from; what they ask and answer is in docs/protocol.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/answer/request.h"

request_function measure_answer_reach, measure_answer_truth, measure_answer_setting, measure_answer_strip;
