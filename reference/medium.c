#include "reference/medium.h"

#include "reference/phase_henyey_greenstein.h"

double medium_phase(const struct medium *medium, double cos_theta)
{
    double phase = 0.0;

    if (medium->lobe_count == 0) return phase_henyey_greenstein(0.0, cos_theta);
    for (size_t i = 0; i < medium->lobe_count; i++) {
        phase += medium->lobes[i].weight * phase_henyey_greenstein(medium->lobes[i].g, cos_theta);
    }
    return phase;
}
