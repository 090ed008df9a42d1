// A point that shines into a cone: its radiant intensity, in W/sr, is full up to the angle `inner` from its direction,
// none from `outer` on, and smoothstep of the angle between. Angles are in radians, at most a right one.
struct LightSpot {
    Spectrum intensity;
    vec3 position;
    vec3 direction; // against the light's travel, as a sun's; of length 1
    float inner, outer;
};

// The share of the intensity that is sent against `toward`, which leads to the light and may be of any length; at the
// light itself it is full.
float light_spot_share(LightSpot light, vec3 toward)
{
    float angle = arc(length(cross(light.direction, toward)), dot(light.direction, toward) + 1e-30);
    float s = clamp((light.outer - angle) / max(light.outer - light.inner, 1e-6), 0.0, 1.0);
    return s * s * (3.0 - 2.0 * s);
}

LightSample light_spot(LightSpot light, vec3 point)
{
    LightSample seen = light_point(LightPoint(light.intensity, light.position), point);
    seen.irradiance *= light_spot_share(light, seen.direction);
    return seen;
}
