// Normalized over the sphere; g in (-1, 1), forward positive. Henyey and Greenstein, Astrophysical Journal 93, 1941.
struct PhaseHenyeyGreenstein { float g; };

// Takes two unit vectors, the directions of travel before and after. 1 + g g - 2 g cos is written as (1 - |g|)^2 plus a
// term that is never negative, with 1 -+ cos from the vectors' difference or sum: near the peak of a sharp lobe the
// textbook's form cancels, and a cosine itself has too few digits left beside 1.
float phase_henyey_greenstein(PhaseHenyeyGreenstein phase, vec3 incoming, vec3 outgoing)
{
    float size = abs(phase.g);
    vec3 apart = incoming - sign(phase.g) * outgoing;
    float denom = (1.0 - size) * (1.0 - size) + size * dot(apart, apart);
    return INV_4PI * (1.0 - size) * (1.0 + size) / (denom * sqrt(denom));
}
