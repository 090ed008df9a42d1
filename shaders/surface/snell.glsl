// Snell's law: sin after = eta sin before, eta = ior before / ior after. Born and Wolf, Principles of Optics, 1999.
// Cosines that rounding puts outside of [0, 1] are clamped.

// Returns the cosine after the boundary; < 0: total reflection. The square is summed so that for equal iors it is that
// of `cos_in`, and cancels only near the critical angle.
float snell_cos(float cos_in, float eta)
{
    float across = eta * clamp(cos_in, 0.0, 1.0);
    float square = (1.0 - eta) * (1.0 + eta) + across * across;
    return square < 0.0 ? -1.0 : sqrt(square);
}

// Returns the refracted direction. `normal` faces the origin of the ray, `cos_out` >= 0 is from snell_cos.
vec3 snell_refract(vec3 direction, vec3 normal, float cos_in, float cos_out, float eta)
{
    return normalize(eta * direction + (eta * clamp(cos_in, 0.0, 1.0) - cos_out) * normal);
}
