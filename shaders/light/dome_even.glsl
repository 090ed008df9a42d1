// The same radiance from everywhere.
struct LightDomeEven { Spectrum radiance; };

Spectrum light_dome_even_radiance(LightDomeEven light, vec3 toward)
{
    return light.radiance;
}
