// A grid's value at index coordinates: that of the voxel that contains them.
ivec3 density_grid_voxel(DensityGrid grid, vec3 at)
{
    return ivec3(clamp(floor(at + 0.5), vec3(0.0), grid.size - 1.0));
}

// One for each type in which voxels are stored.
float density_grid_nearest(sampler2DArray voxels, DensityGrid grid, vec3 at)
{
    return grid.slope * texelFetch(voxels, density_grid_voxel(grid, at), 0).r + grid.intercept;
}

float density_grid_nearest(usampler2DArray voxels, DensityGrid grid, vec3 at)
{
    return grid.slope * float(texelFetch(voxels, density_grid_voxel(grid, at), 0).r) + grid.intercept;
}

float density_grid_nearest(isampler2DArray voxels, DensityGrid grid, vec3 at)
{
    return grid.slope * float(texelFetch(voxels, density_grid_voxel(grid, at), 0).r) + grid.intercept;
}
