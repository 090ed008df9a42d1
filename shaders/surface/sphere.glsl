// Outward normal of a ball next to a point; in its centre, where all directions are alike, it is up.
vec3 surface_sphere_normal(RegionSphere sphere, vec3 p)
{
    vec3 from = p - sphere.center;
    // Squares of very long or very short lengths would leave the range of floats.
    float size = max(max(abs(from.x), abs(from.y)), abs(from.z));
    return size > 0.0 ? normalize(from / size) : vec3(0.0, 1.0, 0.0);
}
