// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/notice_causes.h"

// How long a cause has to last before a job tells of it, and how long the job then tells of it no more.
static const struct {
    int64_t settle_ms, quiet_ms;
} rules[NOTICE_CAUSE_COUNT] = {
    [NOTICE_ROOT] = {20 * 1000, 3600 * 1000},
    [NOTICE_WORKERS] = {60 * 1000, 3600 * 1000},
};

enum notice_step notice_causes_note(struct notice_told *told, enum notice_cause cause, bool is_there, int64_t now_ms)
{
    if (!is_there) {
        bool was_on = told->is_on;

        told->since_ms = 0;
        told->is_on = false;
        return was_on ? NOTICE_FORGET : NOTICE_NOTHING;
    }
    if (told->is_on) return NOTICE_NOTHING;
    if (told->since_ms == 0 || told->since_ms > now_ms) told->since_ms = now_ms;
    if (now_ms - told->since_ms < rules[cause].settle_ms) return NOTICE_NOTHING;
    if (told->told_ms > 0 && now_ms >= told->told_ms && now_ms - told->told_ms < rules[cause].quiet_ms)
        return NOTICE_NOTHING;
    told->told_ms = now_ms;
    told->is_on = true;
    return NOTICE_TELL;
}
