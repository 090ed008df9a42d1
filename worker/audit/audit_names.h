// An audit in words and numbers, as files and messages have it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/frame_accuracy.h"
#include "worker/audit/audit.h"

const char *audit_name(enum audit_kind kind);      // NULL of AUDIT_NONE
enum audit_kind audit_name_find(const char *name); // AUDIT_NONE where no audit has that name

// What is told of a frame that `method` rendered; of its rays nothing is.
struct frame_accuracy audit_accuracy(const struct audit_result *audit, const char *method);
