// Bilinear: texel i of n has its centre at (i + 1/2) / n. The image repeats, so that its first and its last texels are
// neighbours; its first row is on top, v goes up. The weights have all the digits of a float.
vec3 texture_linear(sampler2D image, vec2 uv)
{
    vec2 at = texture_tile(image, uv) - 0.5;
    vec2 low = floor(at);
    vec2 share = at - low;
    ivec2 size = textureSize(image, 0);
    ivec2 first = ivec2(low);
    ivec2 second = first + 1;
    first += ivec2(lessThan(first, ivec2(0))) * size;
    second -= ivec2(greaterThanEqual(second, size)) * size;
    vec3 top_left = texelFetch(image, first, 0).rgb;
    vec3 bottom_left = texelFetch(image, ivec2(first.x, second.y), 0).rgb;
    vec3 top = top_left + share.x * (texelFetch(image, ivec2(second.x, first.y), 0).rgb - top_left);
    vec3 bottom = bottom_left + share.x * (texelFetch(image, second, 0).rgb - bottom_left);
    return top + share.y * (bottom - top);
}
