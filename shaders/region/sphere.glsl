// A ball.
struct RegionSphere { vec3 center; float radius; };

// The ray's nearest point is computed first, so that a far camera does not cost digits.
vec2 region_sphere_span(RegionSphere sphere, vec3 origin, vec3 direction)
{
    vec3 from = origin - sphere.center;
    float along = -dot(from, direction);
    vec3 nearest = from + along * direction;
    float square = sphere.radius * sphere.radius - dot(nearest, nearest);
    if (square <= 0.0) return SPAN_MISSED;
    float half_chord = sqrt(square);
    return vec2(along - half_chord, along + half_chord);
}

// Returns the distance from a point inside to the face.
float region_sphere_depth(RegionSphere sphere, vec3 p)
{
    return sphere.radius - length(p - sphere.center);
}
