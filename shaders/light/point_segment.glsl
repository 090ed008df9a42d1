// The longest segment next to the light, as a share of the light's distance.
const float LIGHT_POINT_SHARE = 0.15;

// A point light for a segment of a camera ray that is evaluated at `point`, `offset` behind its beginning. Next to the
// light its 1 / r^2 integrates over a segment to an angle: Kulla and Fajardo, Computer Graphics Forum 31, 2012. Its
// direction is that at half of the angle, since phase functions depend on it. In segments shorter than `least` of the
// light's distance the sample at the point will do: farther away segments are even, and over a smooth rise and fall the
// sum of their middles is better than each of its parts.
LightSample light_point_segment(LightPoint light, vec3 point, vec3 direction, float length, float offset, float least)
{
    vec3 toward = light.position - point + (offset - 0.5 * length) * direction;
    float along = dot(toward, direction);
    vec3 off = toward - along * direction;
    float square = dot(off, off);
    LightSample seen = light_point(light, point);
    vec3 first = toward + 0.5 * length * direction;
    if (length < least * sqrt(dot(first, first))) return seen;
    // A light on the ray counts as a micrometre beside it.
    float height = max(sqrt(square), 1e-6);
    float angle = arc(length * height, height * height + (along - 0.5 * length) * (along + 0.5 * length));
    seen.irradiance = light.intensity * (angle / (height * length));
    vec3 middle = normalize(first) + normalize(toward - 0.5 * length * direction);
    if (dot(middle, middle) > 1e-6) seen.direction = normalize(middle);
    return seen;
}
