// A uniformly random point on the unit sphere: belts of one height have one area. Archimedes, On the Sphere and
// Cylinder.
vec3 rough_sphere()
{
    const float TURN = 6.28318530717958648;
    float z = 2.0 * random_next() - 1.0;
    float angle = TURN * random_next();
    return vec3(sqrt((1.0 - z) * (1.0 + z)) * vec2(cos(angle), sin(angle)), z);
}

// Returns the normal of a random facet of a rough surface, on the side of `normal` and towards the origin of
// `direction`; both are unit vectors. Its length is checked before dividing by it: a null vector has no direction.
vec3 rough_normal(vec3 normal, vec3 direction, float roughness)
{
    const int DRAWS = 16;
    if (roughness <= 0.0) return normal;
    for (int draw = 0; draw < DRAWS; ++draw) {
        vec3 facet = normal + roughness * rough_sphere();
        if (dot(facet, normal) > 0.0 && dot(direction, facet) < 0.0) return normalize(facet);
    }
    return normal;
}

// Returns the direction, or its mirror image at the surface, on the side of `side` times the normal.
vec3 rough_side(vec3 direction, vec3 normal, float side)
{
    float along = dot(direction, normal);
    return along * side < 0.0 ? direction - 2.0 * along * normal : direction;
}
