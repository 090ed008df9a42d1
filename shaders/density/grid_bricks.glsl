// Empty parts of a grid. Bricks are cubes of 8 index units a side. For each of them the texture says how many bricks
// away, in the largest of the three directions, the nearest one that may have density is: 0 for itself.
const float DENSITY_GRID_BRICK = 8.0;

// Returns how far in metres a ray runs through empty bricks from the index coordinates `at`; 0 in a brick that may have
// density.
float density_grid_skip(sampler3D bricks, DensityGrid grid, vec3 at, vec3 direction)
{
    vec3 last = vec3(textureSize(bricks, 0) - 1);
    vec3 brick = clamp(floor(at * (1.0 / DENSITY_GRID_BRICK)), vec3(0.0), last);
    float empty_bricks = round(255.0 * texelFetch(bricks, ivec3(brick), 0).r);
    vec3 slope = density_grid_slope(grid, direction);
    // The cube of empty bricks around this one ends ahead at `side`.
    vec3 side = DENSITY_GRID_BRICK *
                (brick + mix(1.0 - vec3(empty_bricks), vec3(empty_bricks), greaterThan(slope, vec3(0.0))));
    vec3 exits = (side - at) * (1.0 / slope); // a constant of the ray, which compilers take out of the loop
    return empty_bricks > 0.0 ? max(min(min(exits.x, exits.y), exits.z), 0.0) : 0.0;
}
