// Tiles on a plane, each `size` metres across and up. `offset` is the vector from the middle of one to the point,
// `normal` a unit vector towards the viewer. The world's y axis is up; on floors and ceilings -z.
vec2 texture_plane_uv(vec3 offset, vec3 normal, vec2 size)
{
    vec3 upright = abs(normal.y) > 0.999 ? vec3(0.0, 0.0, -1.0) : vec3(0.0, 1.0, 0.0);
    vec3 across = normalize(cross(upright, normal));
    vec3 up = cross(normal, across);
    return 0.5 + vec2(dot(offset, across), dot(offset, up)) / size;
}
