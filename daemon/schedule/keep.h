// Which jobs that are over leave the queue by the rules of the settings. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

// Members that are 0: no such rule.
struct keep_rules {
    int64_t jobs;  // so many stay
    int64_t ms;    // they stay for so long after their end
    int64_t bytes; // the files of those that stay are so many bytes at the most
};

struct keep_job {
    int64_t id, finished_ms; // unix time
    int64_t bytes;           // of its files
};

void keep_sort(struct keep_job *jobs, size_t count); // the one that ended first comes first, then by id
// How many leave, of jobs in that order and from the first on, by each rule for itself.
struct keep_choice {
    size_t by_jobs, by_ms, by_bytes, count; // count: by all rules
};
struct keep_choice keep_choose(const struct keep_rules *rules, const struct keep_job *jobs, size_t count,
                               int64_t now_ms);
// The name of the setting by which the job of that index leaves.
const char *keep_rule_of(const struct keep_choice *choice, size_t index);
