// Share of unpolarised light that a smooth boundary of two dielectrics reflects: the mean of both polarisations.
// Fresnel, 1823, as in Born and Wolf, Principles of Optics, 1999. eta = ior before / ior after.
float fresnel_exact(float cos_in, float eta)
{
    float before = clamp(cos_in, 0.0, 1.0);
    float after = snell_cos(cos_in, eta);
    if (after < 0.0) return 1.0;
    if (eta == 1.0) return 0.0; // no boundary; along it this would be 0 / 0
    float across = (eta * before - after) / (eta * before + after);
    float along = (eta * after - before) / (eta * after + before);
    return min(0.5 * (across * across + along * along), 1.0);
}
