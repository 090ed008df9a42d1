// A point light as a segment of a camera ray sees it that is looked at in `point`, its middle, alone. Where a light is nearer to
// the ray than the segment is long, its 1 / r^2 is a peak that middles miss or meet alone; over a segment it is an angle: Kulla
// and Fajardo, Computer Graphics Forum 31, 2012.
LightSample light_point_segment(LightPoint light, vec3 point, vec3 direction, float length)
{
    const float FAR = 20.0; // segments away the middle will do: 2e-4
    vec3 toward = light.position - point;
    float along = dot(toward, direction);
    vec3 off = toward - along * direction;
    float square = dot(off, off);
    LightSample seen = light_point(light, point);
    // Of a smooth rise and fall the middles' sum is better than each of its parts.
    if (square > length * length || abs(along) > FAR * length) return seen;
    // A light on the ray counts as a micrometre beside it.
    float height = max(sqrt(square), 1e-6);
    float angle = arc(length * height, height * height + (along - 0.5 * length) * (along + 0.5 * length));
    seen.irradiance = light.intensity * (angle / (height * length));
    return seen;
}
