// The grid of a point light among the media or close to them: all directions on a square, by an octahedron (Cigolle,
// Donow, Evangelakos, Mara, McGuire and Meyer, Journal of Computer Graphics Techniques 3(2), 2014), and the distance
// from the light. Coordinates are in [0, 1].
struct LightGridRound { vec3 light; float near, far; };

// `direction` points towards the light, `distance` metres away; at the light itself it may be 0.
vec3 light_grid_round_at(LightGridRound grid, vec3 direction, float distance)
{
    vec3 away = -direction / max(abs(direction.x) + abs(direction.y) + abs(direction.z), 1e-6);
    vec2 sides = vec2(away.x < 0.0 ? -1.0 : 1.0, away.y < 0.0 ? -1.0 : 1.0);
    vec2 at = away.z < 0.0 ? (1.0 - abs(away.yx)) * sides : away.xy;
    return vec3(0.5 + 0.5 * at, (distance - grid.near) / (grid.far - grid.near));
}

LightGridRay light_grid_round_ray(LightGridRound grid, vec2 column)
{
    vec2 at = 2.0 * column - 1.0;
    float height = 1.0 - abs(at.x) - abs(at.y);
    vec2 sides = vec2(at.x < 0.0 ? -1.0 : 1.0, at.y < 0.0 ? -1.0 : 1.0);
    vec3 away = normalize(vec3(height < 0.0 ? (1.0 - abs(at.yx)) * sides : at, height));
    return LightGridRay(grid.light + grid.near * away, away, grid.far - grid.near);
}
