// A grid's value at index coordinates: that of the voxel whose cell they are in.
float density_grid_nearest(sampler2DArray voxels, DensityGrid grid, vec3 at)
{
    vec3 voxel = clamp(floor(at + 0.5), vec3(0.0), grid.size - 1.0);
    return grid.gain * texelFetch(voxels, ivec3(voxel), 0).r + grid.bias;
}
