// The texel that contains a point. The image repeats; its first row is on top, v goes up.
vec3 texture_nearest(sampler2D image, vec2 uv)
{
    ivec2 texel = ivec2(texture_tile(image, uv));
    return texelFetch(image, min(texel, textureSize(image, 0) - 1), 0).rgb;
}
