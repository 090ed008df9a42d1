// Normalized over the sphere; g in (-1, 1), forward positive. Henyey and Greenstein, Astrophysical Journal 93, 1941.
struct PhaseHenyeyGreenstein { float g; };

// 1 + g g - 2 g cos is written as (1 - |g|)^2 plus what is never negative: near the peak of a sharp lobe the textbook's
// form cancels.
float phase_henyey_greenstein(PhaseHenyeyGreenstein phase, float cos_theta)
{
    float size = abs(phase.g);
    float away = max(1.0 - sign(phase.g) * cos_theta, 0.0);
    float denom = (1.0 - size) * (1.0 - size) + 2.0 * size * away;
    return INV_4PI * (1.0 - size) * (1.0 + size) / (denom * sqrt(denom));
}
