// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/eta.h"

#include "daemon/schedule/turns.h"

#include <math.h>

// Seconds until an owner whom all workers serve has used as much for their weight as another, who is ahead by `lead_s`:
// that of the other decays, and theirs grows by workers / weight in a second and decays as well.
static double find_catch_up_s(const struct eta_params *params, const struct turns_owner *owner, double lead_s)
{
    double decay = log(2.0) / params->half_life_s;

    return log1p(decay * lead_s * owner->weight / params->workers) / decay;
}

double eta_find_s(const struct eta_params *params)
{
    const struct turns_owner *owner = params->owner;
    double eta_s = params->front_s + params->own_s;

    for (size_t i = 0; i < params->rival_count; i++) {
        const struct turns_owner *rival = params->rivals[i].owner;
        double lead_s = owner->used_s / owner->weight - rival->used_s / rival->weight;
        double alone_s = lead_s < 0 ? fmin(find_catch_up_s(params, owner, -lead_s), params->own_s) : 0;
        double first_s = lead_s > 0 ? find_catch_up_s(params, rival, lead_s) : 0;

        eta_s += fmin(params->rivals[i].seconds, first_s + (params->own_s - alone_s) * rival->weight / owner->weight);
    }
    return eta_s;
}
