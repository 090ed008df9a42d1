// SPDX-License-Identifier: Apache-2.0
#include "reference/medium.h"

#include "reference/phase_henyey_greenstein.h"
#include "reference/phase_rayleigh.h"

static double lobe_phase(const struct medium_lobe *lobe, double cos_theta)
{
    switch (lobe->kind) {
    case SCENE_LOBE_RAYLEIGH:
        return phase_rayleigh(cos_theta);
    case SCENE_LOBE_HENYEY_GREENSTEIN:
        break;
    }
    return phase_henyey_greenstein(lobe->g, cos_theta);
}

double medium_phase(const struct medium *medium, double cos_theta)
{
    double phase = 0.0;

    if (medium->lobe_count == 0) return phase_henyey_greenstein(0.0, cos_theta);
    for (size_t i = 0; i < medium->lobe_count; i++) {
        phase += medium->lobes[i].weight * lobe_phase(&medium->lobes[i], cos_theta);
    }
    return phase;
}

void medium_source(const struct medium *medium, struct vec3 position, double density, double source[static 3])
{
    double glow[3] = {0.0, 0.0, 0.0};

    if (medium->glow.at && density > 0.0) medium->glow.at(medium->glow.field, position, glow);
    for (int c = 0; c < 3; c++)
        source[c] = (medium->emission[c] + glow[c]) * density;
}
