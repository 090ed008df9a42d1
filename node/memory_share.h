// How much memory all workers may take together: what the machine has, or less where a control group allows less.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

// The least memory.max (bytes) of a control group of version 2 and of the groups that it is in; INT64_MAX: no limit.
// `membership` is the text of /proc/PID/cgroup, `mount` where the groups are mounted.
// Source: Linux, Documentation/admin-guide/cgroup-v2.rst.
int64_t memory_share_find_limit(const char *membership, const char *mount);
int64_t memory_share_find_all(void); // bytes that the machine has, or that our control groups allow; reads files
int64_t memory_share_find(void);     // nine tenths of them: what all workers may take
