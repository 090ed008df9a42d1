// Walks that were scattered often go on through a similar medium: light cannot tell any more how sharp each scattering
// was. A forward lobe of g becomes an even cap of directions up to cos = g - 1, which scatters less: both
// sigma_s (1 - g) and sigma_s (1 - g^2), the first two moments, stay. Wyman, Patterson and Wilson, Similarity relations
// for anisotropic scattering, Journal of Computational Physics 81, 1989.

// What is left of a lobe's scattering.
float similar_share(float g)
{
    return g > 0.0 ? 2.0 * (1.0 - g) / (2.0 - g) : 1.0;
}

// The phase function of the cap, times that share.
float similar_phase(float g, vec3 incoming, vec3 outgoing)
{
    if (g <= 0.0) return phase_henyey_greenstein(PhaseHenyeyGreenstein(g), incoming, outgoing);
    return dot(incoming, outgoing) >= g - 1.0 ? INV_4PI * 2.0 / (2.0 - g) * similar_share(g) : 0.0;
}

// Returns 1 - cos of a random angle, for `share` in [0, 1).
float similar_less(float g, float share)
{
    return g > 0.0 ? (2.0 - g) * share : scatter_henyey_greenstein(g, share);
}
