// A ball.
struct RegionSphere { vec3 center; float radius; };

// The nearest point of the ray is taken first, so that a far camera keeps its digits.
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

// How deep in it a point is: distance to its face.
float region_sphere_depth(RegionSphere sphere, vec3 p)
{
    return sphere.radius - length(p - sphere.center);
}
