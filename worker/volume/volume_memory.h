// How much memory this process may hope for: to refuse a volume with numbers, not to be killed half-way.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;

// The machine's memory, or what the control groups allow if that is less.
int64_t volume_memory_limit(void);
// The least limit of a group and those above it, of version 1 or 2, by /proc/self/cgroup's text; INT64_MAX: none.
// `root` is where they are mounted.
int64_t volume_memory_group_limit(const char *groups, const char *root);
// "needs N GiB, M GiB are available" when `size_bytes` are more than `limit_bytes`.
bool volume_memory_check(int64_t size_bytes, int64_t limit_bytes, struct error *error);
