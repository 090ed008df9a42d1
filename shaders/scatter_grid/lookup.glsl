// The grid of scattered light between its nodes: linear in each direction. Several sets of values lie one behind the
// other along z, and none is mixed with the next.
vec4 scatter_grid_look(sampler3D scattered, vec3 at, int set, int sets)
{
    vec3 size = vec3(textureSize(scattered, 0));
    vec3 nodes = vec3(size.xy, size.z / float(sets));
    vec3 texel = clamp(at, 0.0, 1.0) * (nodes - 1.0) + 0.5;
    texel.z += float(set) * nodes.z;
    vec4 value = textureLod(scattered, texel / size, 0.0);
    if (value.a < 0.0) march_was_cut = true; // a node whose walks were cut
    return value;
}
