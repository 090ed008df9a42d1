// What a GL context reports about itself: its backend, driver and device.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct gl_context;

typedef void gl_function(void); // to be cast to the function's own type

struct gl_context_facts {
    const char *backend; // "egl" or "osmesa"
    char vendor[128], renderer[128], version[128];
    char device_uuid[40]; // 8-4-4-4-12; empty when unknown
    bool is_software;
};
