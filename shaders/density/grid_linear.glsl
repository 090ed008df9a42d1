// A grid's value at index coordinates by trilinear interpolation between voxel centres; beyond the outer ones it is
// constant. The eight voxels are gathered as they are and mixed as floats: filtering done by the driver may round
// positions to 1/256 of a voxel, and values to those of an 8-bit texture.
struct DensityGridCell {
    vec3 share;     // from the lower to the upper centres, in [0, 1]
    vec3 near, far; // where to gather the four voxels of the lower slice, and those of the upper
};

DensityGridCell density_grid_cell(DensityGrid grid, vec3 at)
{
    at = clamp(at, vec3(0.0), grid.size - 1.0);
    vec3 cell = floor(at);
    vec3 share = at - cell;
    // Gathering at the corner that four voxels of a slice share, rounding cannot pick others.
    vec2 corner = (cell.xy + 1.0) * (1.0 / grid.size.xy);
    return DensityGridCell(share, vec3(corner, cell.z), vec3(corner, min(cell.z + 1.0, grid.size.z - 1.0)));
}

float density_grid_mix(DensityGrid grid, vec3 share, vec4 near, vec4 far)
{
    vec4 slice = near + share.z * (far - near);
    // The order of a gather: (0, 1), (1, 1), (1, 0), (0, 0).
    vec2 row = slice.wz + share.y * (slice.xy - slice.wz);
    return grid.slope * (row.x + share.x * (row.y - row.x)) + grid.intercept;
}

// One for each type in which voxels are stored.
float density_grid_linear(sampler2DArray voxels, DensityGrid grid, vec3 at)
{
    DensityGridCell cell = density_grid_cell(grid, at);
    return density_grid_mix(grid, cell.share, textureGather(voxels, cell.near), textureGather(voxels, cell.far));
}

float density_grid_linear(usampler2DArray voxels, DensityGrid grid, vec3 at)
{
    DensityGridCell cell = density_grid_cell(grid, at);
    return density_grid_mix(grid, cell.share, vec4(textureGather(voxels, cell.near)),
                            vec4(textureGather(voxels, cell.far)));
}

float density_grid_linear(isampler2DArray voxels, DensityGrid grid, vec3 at)
{
    DensityGridCell cell = density_grid_cell(grid, at);
    return density_grid_mix(grid, cell.share, vec4(textureGather(voxels, cell.near)),
                            vec4(textureGather(voxels, cell.far)));
}
