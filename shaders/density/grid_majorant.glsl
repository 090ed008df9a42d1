// The largest value of each brick of a grid, or the largest opacity of its values under a transfer function. Bricks are
// as in density/grid_bricks.glsl. Where a brick has nothing, the texture says how many bricks away the nearest one is
// that has something, as a negative number.

// What does not change along a ray.
struct DensityGridRay {
    vec3 from, slope; // index coordinates of the origin, and per metre
    vec3 metres;      // per index unit
    float least;      // length of a cell, so that rounding at a face stops no ray
};

DensityGridRay density_grid_ray(DensityGrid grid, vec3 origin, vec3 direction)
{
    const float LEAST = 1e-3; // of a voxel
    vec3 slope = density_grid_slope(grid, direction);
    return DensityGridRay(density_grid_index(grid, origin), slope, 1.0 / slope, LEAST / length(slope));
}

// Returns the majorant `distance` metres along the ray; <= 0 where there is nothing. It holds for `extent` metres.
float density_grid_majorant(sampler3D majorants, DensityGridRay ray, float distance, out float extent)
{
    vec3 last = vec3(textureSize(majorants, 0) - 1);
    vec3 at = ray.from + distance * ray.slope;
    vec3 brick = clamp(floor(at * (1.0 / DENSITY_GRID_BRICK)), vec3(0.0), last);
    float majorant = texelFetch(majorants, ivec3(brick), 0).r;
    float around = max(-majorant - 1.0, 0.0); // bricks to each side that have nothing either
    // Outer bricks reach to the box's faces, half a voxel beyond the outer centres.
    vec3 low = brick - around;
    low = mix(DENSITY_GRID_BRICK * low, vec3(-1.0), lessThan(low, vec3(0.5)));
    vec3 side = mix(low, DENSITY_GRID_BRICK * (brick + around + 1.0), greaterThan(ray.slope, vec3(0.0)));
    vec3 exits = (side - at) * ray.metres;
    extent = max(min(min(exits.x, exits.y), exits.z), ray.least);
    return majorant;
}
