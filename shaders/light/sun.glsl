// Parallel light from infinitely far; `direction` is a unit vector towards it.
struct LightSun { Spectrum irradiance; vec3 direction; };

LightSample light_sun(LightSun light)
{
    return LightSample(light.direction, FAR_AWAY, light.irradiance);
}
