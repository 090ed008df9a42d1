// The objects of the protocol that several methods and events share, as the OpenRPC document describes them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/requests/method.h"

extern const struct shape shape_job;

extern const struct shape *const shapes[]; // all that a type may name; ends in NULL

const struct shape *shapes_find(const char *name, size_t length); // NULL: there is no such shape
