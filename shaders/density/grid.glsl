// A box of voxels. Voxel (i, j, k) has its centre at the index coordinates (i, j, k); the box ends half a voxel beyond
// the outer centres.
struct DensityGrid {
    mat3 to_index;          // per metre
    vec3 shift;             // index coordinates of the world's origin
    vec3 size;              // voxels
    float slope, intercept; // value = slope * stored number + intercept
};

vec3 density_grid_index(DensityGrid grid, vec3 p)
{
    return grid.to_index * p + grid.shift;
}

// Index coordinates per metre along the direction. A direction along a face of the box gets a slope too small to change
// a sum: without one, 0 / 0 would be NaN.
vec3 density_grid_slope(DensityGrid grid, vec3 direction)
{
    const float LEAST = 1e-20;
    vec3 slope = grid.to_index * direction;
    return mix(slope, vec3(LEAST), lessThan(abs(slope), vec3(LEAST)));
}

// Distances along the ray to the entry into the box and the exit from it; entry > exit where it misses.
vec2 density_grid_span(DensityGrid grid, vec3 origin, vec3 direction)
{
    vec3 at = density_grid_index(grid, origin);
    vec3 slope = density_grid_slope(grid, direction);
    vec3 low = (vec3(-0.5) - at) / slope;
    vec3 high = (grid.size - 0.5 - at) / slope;
    vec3 entries = min(low, high);
    vec3 exits = max(low, high);
    return vec2(max(max(entries.x, entries.y), entries.z), min(min(exits.x, exits.y), exits.z));
}
