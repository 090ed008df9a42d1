// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/pace.h"

#include <math.h>
#include <stddef.h>

// Of an answer that comes with the one before.
static const double SHORTEST_S = 1e-6;

void pace_begin(struct pace *pace, uint64_t now_ns)
{
    pace->answered_ns = now_ns;
    pace->planned_s = 0.0;
}

void pace_begin_plan(struct pace *pace, uint64_t now_ns)
{
    pace->planning_ns = now_ns;
}

// Seconds of the plan that is being made, from the latest answer on.
static double find_planning_s(const struct pace *pace, uint64_t now_ns)
{
    uint64_t since_ns = pace->planning_ns > pace->answered_ns ? pace->planning_ns : pace->answered_ns;

    return pace->planning_ns > 0 ? (double)(now_ns - since_ns) * 1e-9 : 0.0;
}

double pace_end_plan(struct pace *pace, uint64_t now_ns)
{
    double seconds = pace->planning_ns > 0 ? (double)(now_ns - pace->planning_ns) * 1e-9 : -1.0;

    pace->planned_s += find_planning_s(pace, now_ns);
    pace->planning_ns = 0;
    return seconds;
}

void pace_drop_plan(struct pace *pace)
{
    pace->planning_ns = 0;
}

double pace_answer(struct pace *pace, int64_t job, uint64_t now_ns, bool *is_first)
{
    double seconds = (double)(now_ns - pace->answered_ns) * 1e-9 - pace->planned_s - find_planning_s(pace, now_ns);

    if (is_first) *is_first = pace->job != job || pace->planned_s > 0.0;
    pace->answered_ns = now_ns;
    pace->planned_s = 0.0;
    pace->job = job;
    return fmax(seconds, SHORTEST_S);
}
