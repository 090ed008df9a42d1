// Spots over a whole segment of a ray: beams may be narrower than the segment.

// The integral of the spot's share from `begin` to `end` of a ray, by Simpson's rule: exact for a smoothstep of the
// distance, which that of a narrow cone is.
float light_spot_fade(LightSpot light, vec3 toward, vec3 direction, float begin, float end)
{
    if (end <= begin) return 0.0;
    float middle = 0.5 * (begin + end);
    return (light_spot_share(light, toward - begin * direction) + light_spot_share(light, toward - end * direction) +
            4.0 * light_spot_share(light, toward - middle * direction)) * (end - begin) / 6.0;
}

// The mean of the spot's share over the segment from `start`.
float light_spot_mean(LightSpot light, vec3 start, vec3 direction, float length)
{
    vec2 outer = clamp(light_spot_lit(light, start, direction), 0.0, length);
    if (outer.x >= outer.y) return 0.0;
    vec2 inner = light_spot_crossed(light, start, direction, light.inner);
    vec3 toward = light.position - start;
    // Where the ray misses the inner cone it is brightest next to the axis, about in the middle.
    inner = inner.x < inner.y ? clamp(inner, outer.x, outer.y) : vec2(0.5 * (outer.x + outer.y));
    return (light_spot_fade(light, toward, direction, outer.x, inner.x) + inner.y - inner.x +
            light_spot_fade(light, toward, direction, inner.y, outer.y)) / length;
}

// As light_point_segment, with the mean of the share.
LightSample light_spot_segment(LightSpot light, vec3 point, vec3 direction, float length, float offset, float least)
{
    LightSample seen = light_point_segment(LightPoint(light.intensity, light.position), point, direction, length,
                                           offset, least);
    seen.irradiance *= light_spot_mean(light, point - offset * direction, direction, length);
    return seen;
}

// At a node of Gauss' rule, which follows the share by itself.
LightSample light_spot_node(LightSpot light, vec3 point, vec3 direction, float length, float offset, float least)
{
    LightSample seen = light_point_segment(LightPoint(light.intensity, light.position), point, direction, length,
                                           offset, least);
    seen.irradiance *= light_spot_share(light, light.position - point);
    return seen;
}
