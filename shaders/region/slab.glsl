// The space between two parallel planes; `normal` is a unit vector.
struct RegionSlab { vec3 center, normal; float half_thickness; };

// A ray parallel to the planes is tilted by less than its own rounding, so that 0 / 0 does not occur.
vec2 region_slab_span(RegionSlab slab, vec3 origin, vec3 direction)
{
    const float PARALLEL = 1e-20;
    float slope = dot(slab.normal, direction);
    if (abs(slope) < PARALLEL) slope = PARALLEL;
    float from = dot(slab.normal, origin - slab.center);
    float low = (-slab.half_thickness - from) / slope;
    float high = (slab.half_thickness - from) / slope;
    return clamp(vec2(min(low, high), max(low, high)), -FAR_AWAY, FAR_AWAY);
}

// Returns the distance from a point inside to the nearest face.
float region_slab_depth(RegionSlab slab, vec3 p)
{
    return slab.half_thickness - abs(dot(slab.normal, p - slab.center));
}
