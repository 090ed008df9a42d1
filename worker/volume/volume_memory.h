// How much memory this process may use: a volume that is too large is refused with numbers, before the kernel kills us.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;

// Returns the machine's memory, or the limit of the control groups if that is less, in bytes.
int64_t volume_memory_limit(void);
// Returns the least limit of a group and its parents, version 1 or 2; INT64_MAX: none. `groups` is the text of
// /proc/self/cgroup; `root` is where the groups are mounted.
int64_t volume_memory_group_limit(const char *groups, const char *root);
// Fails with "needs N GiB of memory, M GiB are available" when `size_bytes` is more than `limit_bytes`.
bool volume_memory_check(int64_t size_bytes, int64_t limit_bytes, struct error *error);
