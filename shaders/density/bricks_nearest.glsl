// A sparse grid's value at the nearest voxel centre; a brick's atlas includes the next brick's first voxels.
float density_bricks_nearest(sampler2DArray atlas, uvec4 brick, vec3 at)
{
    vec3 within = at - BRICK_SIDE * floor(at / BRICK_SIDE);
    return texelFetch(atlas, ivec3(brick.xyz) * BRICK_TEXELS + ivec3(within + 0.5), 0).r;
}
