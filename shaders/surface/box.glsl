// Outward normal of a box next to a point: that of the nearest face. On edges it is that of one of their faces.
vec3 surface_box_normal(RegionBox box, vec3 p)
{
    vec3 from = p - box.center;
    vec3 beyond = abs(from) - box.half_size;
    vec3 toward = mix(vec3(1.0), vec3(-1.0), lessThan(from, vec3(0.0)));
    if (beyond.x >= beyond.y && beyond.x >= beyond.z) return vec3(toward.x, 0.0, 0.0);
    return beyond.y >= beyond.z ? vec3(0.0, toward.y, 0.0) : vec3(0.0, 0.0, toward.z);
}
