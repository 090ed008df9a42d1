// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_scouting.h"

#include <math.h>

// Shares of the tolerance: the error above which a frame is refined, and the error that it then should have. Set by
// hand; bench/predictions shows predicted and measured errors.
static const double SHARE_ALLOWED = 0.9, SHARE_WANTED = 0.6;
// Order of the error in the step: methods of second order keep 1.5 where densities have kinks.
static const double ORDER = 1.5;

int64_t plan_scouting_index(const struct plan_scouting *scouting, int i)
{
    if (scouting->count == 1) return scouting->first;
    return scouting->first + i * (scouting->last - scouting->first) / (scouting->count - 1);
}

static double find_error(const struct plan_scouting *scouting, int64_t index)
{
    int i = 1;

    while (i < scouting->count - 1 && plan_scouting_index(scouting, i) < index)
        i++;
    {
        int64_t before = plan_scouting_index(scouting, i - 1), after = plan_scouting_index(scouting, i);
        double share = (double)(index - before) / (double)(after - before);

        return scouting->error[i - 1] + share * (scouting->error[i] - scouting->error[i - 1]);
    }
}

int plan_scouting_find_rungs(const struct plan_scouting *scouting, int64_t index, double tolerance)
{
    double error;

    if (scouting->count == 0 || index < scouting->first || index > scouting->last) return 0;
    error = find_error(scouting, index);
    if (error <= SHARE_ALLOWED * tolerance) return 0;
    return (int)ceil(2.0 * log2(error / (SHARE_WANTED * tolerance)) / ORDER);
}

double plan_scouting_predict_error(const struct plan_scouting *scouting, double tolerance)
{
    double sum = 0.0;

    for (int64_t index = scouting->first; index <= scouting->last; index++) {
        int rungs = plan_scouting_find_rungs(scouting, index, tolerance);
        double error = find_error(scouting, index) * exp2(-0.5 * ORDER * rungs);

        sum += error * error;
    }
    return sqrt(sum / (double)(scouting->last - scouting->first + 1));
}
