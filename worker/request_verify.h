// worker.verify: what files of a sequence hold, and what is wrong with each by itself.
#pragma once

#include "worker/request.h"

request_function request_answer_verify;
