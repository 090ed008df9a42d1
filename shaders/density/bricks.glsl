// A sparse grid: bricks of 8^3 voxels on a lattice. Voxel (i, j, k) of the lattice has its centre at the coordinates
// (i, j, k); its first brick begins at 0. For each brick an index says where its voxels are in an atlas of bricks, each
// with the next brick's first voxels on three sides (xyz, counted in bricks), and how many bricks away, in the largest
// of the three directions, the nearest one with density is (w).
const float BRICK_SIDE = 8.0;
const int BRICK_TEXELS = 9;

struct DensityBricks {
    mat3 to_lattice; // per metre
    vec3 shift;      // lattice coordinates of the world's origin
    vec3 low, high;  // the box in lattice coordinates: one voxel beyond the centres of the outermost active ones
};

// Rounding may put a point of the box's face outside of it.
vec3 density_bricks_at(DensityBricks grid, vec3 p)
{
    return clamp(grid.to_lattice * p + grid.shift, grid.low, grid.high);
}

// Lattice coordinates per metre along the direction. A direction along a face gets a slope too small to change a sum:
// without one, 0 / 0 would be NaN.
vec3 density_bricks_slope(DensityBricks grid, vec3 direction)
{
    const float LEAST = 1e-20;
    vec3 slope = grid.to_lattice * direction;
    return mix(slope, vec3(LEAST), lessThan(abs(slope), vec3(LEAST)));
}

// Distances along the ray to the entry into the box and the exit from it; entry > exit where it misses.
vec2 density_bricks_span(DensityBricks grid, vec3 origin, vec3 direction)
{
    vec3 at = grid.to_lattice * origin + grid.shift;
    vec3 slope = density_bricks_slope(grid, direction);
    vec3 low = (grid.low - at) / slope;
    vec3 high = (grid.high - at) / slope;
    vec3 entries = min(low, high);
    vec3 exits = max(low, high);
    return vec2(max(max(entries.x, entries.y), entries.z), min(min(exits.x, exits.y), exits.z));
}

uvec4 density_bricks_find(usampler3D index, vec3 at)
{
    return texelFetch(index, ivec3(at / BRICK_SIDE), 0);
}

// Returns how far in metres a ray runs through bricks without density from `at`, which lies in such a brick.
float density_bricks_skip(DensityBricks grid, uvec4 brick, vec3 at, vec3 direction)
{
    float empty_bricks = float(brick.w);
    vec3 slope = density_bricks_slope(grid, direction);
    // The cube of such bricks around this one ends ahead at `side`.
    vec3 side = BRICK_SIDE * (floor(at / BRICK_SIDE) +
                              mix(vec3(1.0 - empty_bricks), vec3(empty_bricks), greaterThan(slope, vec3(0.0))));
    vec3 exits = (side - at) / slope;
    return max(min(min(exits.x, exits.y), exits.z), 0.0);
}
