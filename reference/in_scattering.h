// The light of lamps and suns that media scatter into a ray.
// SPDX-License-Identifier: Apache-2.0
// The light that arrives is computed at a few nodes and interpolated between them, because it varies less than the
// densities do, and each of its values costs a walk to a light. The radiance is linear in these values. So it is known
// beforehand what each of them counts, how exact it has to be, and which of them need not be computed.
#pragma once

#include "reference/profile.h"

struct in_scattering_params {
    const struct still *still;
    struct profile *profile;       // its cells are refined further
    const struct span_list *spans; // the profile's: cells begin as these
    double relative, floor;        // as in struct integrate_accuracy
    int halving_limit;
};

// Adds to `radiance`, which holds what is emitted. False when a limit ended the refinement somewhere.
bool in_scattering_add(const struct in_scattering_params *params, double radiance[static 3]);
