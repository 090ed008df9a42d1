// A sparse grid's value by the nearest voxel centre, which a brick's atlas has up to the next brick's first.
float density_bricks_nearest(sampler2DArray atlas, uvec4 brick, vec3 at)
{
    vec3 within = at - BRICK_SIDE * floor(at / BRICK_SIDE);
    return texelFetch(atlas, ivec3(brick.xyz) * BRICK_TEXELS + ivec3(within + 0.5), 0).r;
}
