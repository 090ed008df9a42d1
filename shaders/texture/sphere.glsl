// Once around a sphere, by its outward unit normal: u from left to right with 1/2 at +z, v up from pole to pole on y.
vec2 texture_sphere_uv(vec3 normal)
{
    const float PI = 3.14159265358979324;
    float level = length(normal.xz);
    float angle = level > 0.0 ? atan(normal.x, normal.z) : 0.0;
    return 0.5 + vec2(angle / (2.0 * PI), atan(normal.y, level) / PI);
}
