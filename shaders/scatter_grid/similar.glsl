// Walks that were scattered often go on through a similar medium: light cannot tell any more how sharp each scattering
// was. A forward lobe of g becomes an even part and an even cap of directions about the one ahead, which scatter less:
// sigma_s (1 - g^n), for n of 1, 2 and 3, stays what it was. One such medium has these moments: that whose cap ends at
// cos = (4 g - 1) / 5. Wyman, Patterson and Wilson, Similarity relations for anisotropic scattering, Journal of
// Computational Physics 81, 1989.

float similar_edge(float g)
{
    return (4.0 * g - 1.0) / 5.0;
}

// What is left of a lobe's scattering.
float similar_share(float g)
{
    return g > 0.0 ? (1.0 - g) * (6.0 + g) / (6.0 - 4.0 * g) : 1.0;
}

// What the cap scatters of all that the lobe did.
float similar_cap(float g)
{
    float edge = similar_edge(g);
    return 2.0 * g * (1.0 - g) / ((1.0 - edge) * (1.0 + edge));
}

// The phase function of both, times what is left.
float similar_phase(float g, vec3 incoming, vec3 outgoing)
{
    if (g <= 0.0) return phase_henyey_greenstein(PhaseHenyeyGreenstein(g), incoming, outgoing);
    float edge = similar_edge(g);
    float cap = similar_cap(g);
    float ahead = dot(incoming, outgoing) >= edge ? 2.0 * cap / (1.0 - edge) : 0.0;
    return INV_4PI * (similar_share(g) - cap + ahead);
}

// Returns 1 - cos of a random angle, for `share` in [0, 1).
float similar_less(float g, float share)
{
    if (g <= 0.0) return scatter_henyey_greenstein(g, share);
    float cap = similar_cap(g) / similar_share(g);
    return share < cap ? (1.0 - similar_edge(g)) * share / cap : 2.0 * (share - cap) / (1.0 - cap);
}
