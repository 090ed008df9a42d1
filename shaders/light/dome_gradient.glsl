// Radiance that is linear in the cosine to an axis: `radiance` along it, `opposite` against it.
struct LightDomeGradient {
    Spectrum radiance, opposite;
    vec3 axis; // of length 1
};

Spectrum light_dome_gradient_radiance(LightDomeGradient light, vec3 toward)
{
    return light.opposite + (light.radiance - light.opposite) * (0.5 + 0.5 * dot(light.axis, toward));
}
