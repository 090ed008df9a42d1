// All that lies behind a plane; `normal` is a unit vector and points out of it.
struct RegionPlane { vec3 point, normal; };

// A ray along the plane is tilted by less than its own rounding, so that 0 / 0 does not come up.
vec2 region_plane_span(RegionPlane plane, vec3 origin, vec3 direction)
{
    const float PARALLEL = 1e-20;
    float slope = dot(plane.normal, direction);
    if (abs(slope) < PARALLEL) slope = PARALLEL;
    float crossing = clamp(dot(plane.normal, plane.point - origin) / slope, -FAR_AWAY, FAR_AWAY);
    vec2 span = slope < 0.0 ? vec2(crossing, FAR_AWAY) : vec2(-FAR_AWAY, crossing);
    return span.x < span.y ? span : SPAN_MISSED;
}
