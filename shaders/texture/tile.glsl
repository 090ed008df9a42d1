// A point's position in an image that repeats in both directions, in texels from its top left corner: [0, size].
vec2 texture_tile(sampler2D image, vec2 uv)
{
    vec2 tile = clamp(uv - floor(uv), 0.0, 1.0);
    return vec2(tile.x, 1.0 - tile.y) * vec2(textureSize(image, 0));
}
