// Which way a ball's surface faces next to a point. In its middle, where it faces all ways, that is up.
vec3 surface_sphere_normal(RegionSphere sphere, vec3 p)
{
    vec3 from = p - sphere.center;
    // Squares of what is very long or very short are no numbers any more.
    float size = max(max(abs(from.x), abs(from.y)), abs(from.z));
    return size > 0.0 ? normalize(from / size) : vec3(0.0, 1.0, 0.0);
}
