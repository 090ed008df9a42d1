// A grid's value at index coordinates by trilinear interpolation between voxel centres; beyond the outer ones it holds. The
// eight voxels are gathered as they are and mixed as floats: filtering done by the driver may round positions to 1/256 of a
// voxel, and values to those of an 8-bit texture.
float density_grid_linear(sampler2DArray voxels, DensityGrid grid, vec3 at)
{
    at = clamp(at, vec3(0.0), grid.size - 1.0);
    vec3 cell = floor(at);
    vec3 share = at - cell;
    // The corner that four voxels of a slice have in common: gathered there, rounding cannot pick others.
    vec2 corner = (cell.xy + 1.0) * (1.0 / grid.size.xy);
    vec4 near = textureGather(voxels, vec3(corner, cell.z));
    vec4 far = textureGather(voxels, vec3(corner, min(cell.z + 1.0, grid.size.z - 1.0)));
    vec4 slice = near + share.z * (far - near);
    // In the order of a gather: (0, 1), (1, 1), (1, 0), (0, 0).
    vec2 row = slice.wz + share.y * (slice.xy - slice.wz);
    return grid.gain * (row.x + share.x * (row.y - row.x)) + grid.bias;
}
