// A sparse grid's value by trilinear interpolation between voxel centres. The eight voxels are gathered as they are and
// mixed as floats: filtering done by the driver may round positions to 1/256 of a voxel.
float density_bricks_linear(sampler2DArray atlas, uvec4 brick, vec3 at)
{
    vec3 within = at - BRICK_SIDE * floor(at / BRICK_SIDE);
    vec3 cell = floor(within);
    vec3 share = within - cell;
    vec3 texel = vec3(ivec3(brick.xyz) * BRICK_TEXELS) + cell;
    // Gathering at the corner that four texels of a layer share, rounding cannot pick others.
    vec2 corner = (texel.xy + 1.0) / vec2(textureSize(atlas, 0).xy);
    vec4 near = textureGather(atlas, vec3(corner, texel.z));
    vec4 far = textureGather(atlas, vec3(corner, texel.z + 1.0));
    vec4 layer = near + share.z * (far - near);
    // The order of a gather: (0, 1), (1, 1), (1, 0), (0, 0).
    vec2 row = layer.wz + share.y * (layer.xy - layer.wz);
    return row.x + share.x * (row.y - row.x);
}
