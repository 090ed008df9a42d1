// A moment as people write it: "30d" ago, or a date. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;

// Reads `90s`, `15m`, `12h`, `30d` or `2w`; more than nothing.
bool moment_parse_span(const char *text, int64_t *seconds, struct error *error);
// Reads `90s`, `15m`, `12h`, `30d` or `2w`: so long before `now_s`; or a date, `2026-03-01` or `2026-03-01T18:30`, in
// local time. `*unix_s` is at least 0.
bool moment_parse(const char *text, int64_t now_s, int64_t *unix_s, struct error *error);
