// The half space behind a plane; `normal` is its outward unit normal.
struct RegionPlane { vec3 point, normal; };

// A ray parallel to the plane is tilted by less than its own rounding, so that 0 / 0 does not occur.
vec2 region_plane_span(RegionPlane plane, vec3 origin, vec3 direction)
{
    const float PARALLEL = 1e-20;
    float slope = dot(plane.normal, direction);
    if (abs(slope) < PARALLEL) slope = PARALLEL;
    float crossing = clamp(dot(plane.normal, plane.point - origin) / slope, -FAR_AWAY, FAR_AWAY);
    vec2 span = slope < 0.0 ? vec2(crossing, FAR_AWAY) : vec2(-FAR_AWAY, crossing);
    return span.x < span.y ? span : SPAN_MISSED;
}
