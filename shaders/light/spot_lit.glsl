// Where a ray is in a spot's cones.

// The stretch of the ray within the cone of half-angle `angle`, x to y, without end where the cone has none; x >= y:
// there is none. In the cone the part across its axis is at most the tangent times that along it: a quadratic in the
// distance, with what is across found as such, so that narrow cones are not differences of large numbers.
vec2 light_spot_crossed(LightSpot light, vec3 start, vec3 direction, float angle)
{
    const vec2 NOWHERE = vec2(FAR_AWAY, -FAR_AWAY);
    vec3 from = start - light.position;
    float foot = -dot(from, direction); // distances are counted from the point next to the light
    from += foot * direction;
    vec3 across = cos(angle) * cross(light.direction, from);
    vec3 turn = cos(angle) * cross(light.direction, direction);
    float along = -sin(angle) * dot(light.direction, from);
    float slope = -sin(angle) * dot(light.direction, direction);
    float square = dot(turn, turn) - slope * slope;
    float half_b = dot(turn, across) - slope * along;
    float rest = dot(across, across) - along * along;
    float root = half_b * half_b - square * rest;
    // A ray that gets nowhere along the axis never enters a cone that is a half-space.
    if (root < 0.0 && square > 0.0 || slope == 0.0 && along <= 0.0) return NOWHERE;
    root = sqrt(max(root, 0.0));
    float sum = half_b < 0.0 ? half_b - root : half_b + root;
    // A ray along the cone crosses it once.
    float first = abs(square) * FAR_AWAY > abs(sum) ? -sum / square : (slope > 0.0 ? -FAR_AWAY : FAR_AWAY);
    float second = sum != 0.0 ? -rest / sum : first;
    vec2 ends = vec2(min(first, second), max(first, second));
    if (square <= 0.0) return foot + (slope > 0.0 ? vec2(ends.y, FAR_AWAY) : vec2(-FAR_AWAY, ends.x));
    return along + 0.5 * (ends.x + ends.y) * slope > 0.0 ? foot + ends : NOWHERE;
}

// The stretch of the ray on which the spot shines.
vec2 light_spot_lit(LightSpot light, vec3 start, vec3 direction)
{
    return light_spot_crossed(light, start, direction, light.outer);
}
