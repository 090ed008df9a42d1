// A box along the world's axes.
struct RegionBox { vec3 center, half_size; };

// A ray parallel to a face is tilted by less than its own rounding, so that 0 / 0 does not occur.
vec2 region_box_span(RegionBox box, vec3 origin, vec3 direction)
{
    const float PARALLEL = 1e-20;
    vec3 slope = mix(direction, vec3(PARALLEL), lessThan(abs(direction), vec3(PARALLEL)));
    vec3 from = origin - box.center;
    vec3 low = (-box.half_size - from) / slope;
    vec3 high = (box.half_size - from) / slope;
    vec3 entries = min(low, high);
    vec3 exits = max(low, high);
    vec2 span = vec2(max(max(entries.x, entries.y), entries.z), min(min(exits.x, exits.y), exits.z));
    return span.x < span.y ? clamp(span, -FAR_AWAY, FAR_AWAY) : SPAN_MISSED;
}

// Returns the distance from a point inside to the nearest face.
float region_box_depth(RegionBox box, vec3 p)
{
    vec3 depth = box.half_size - abs(p - box.center);
    return min(min(depth.x, depth.y), depth.z);
}
