// The largest value of each brick of a grid, or the largest opacity of its values under a transfer function. Bricks are
// as in density/grid_bricks.glsl.

// Returns the majorant of the brick at index coordinates. `extent` is how far in metres the ray runs through it, at
// least a thousandth of a voxel, so that rounding at a face stops no ray.
float density_grid_majorant(sampler3D majorants, DensityGrid grid, vec3 at, vec3 direction, out float extent)
{
    const float LEAST = 1e-3;
    vec3 last = vec3(textureSize(majorants, 0) - 1);
    vec3 brick = clamp(floor(at * (1.0 / DENSITY_GRID_BRICK)), vec3(0.0), last);
    vec3 slope = density_grid_slope(grid, direction);
    // Outer bricks reach to the box's faces, half a voxel beyond the outer centres.
    vec3 low = mix(DENSITY_GRID_BRICK * brick, vec3(-1.0), lessThan(brick, vec3(0.5)));
    vec3 side = mix(low, DENSITY_GRID_BRICK * (brick + 1.0), greaterThan(slope, vec3(0.0)));
    vec3 exits = (side - at) / slope;
    extent = max(min(min(exits.x, exits.y), exits.z), LEAST / length(slope));
    return texelFetch(majorants, ivec3(brick), 0).r;
}
