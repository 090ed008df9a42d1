// Columns of media towards a light from its grid, a channel a medium, linear between nodes, which are the texels'
// centres. A driver whose filter has weights of 8 bits errs by less than a 500th of a cell's difference.
const float LIGHT_GRID_WAS_CUT = -1e5; // far below any prepared column

vec4 transmittance_cached(sampler3D columns, vec3 at)
{
    vec3 size = vec3(textureSize(columns, 0));
    vec4 column = textureLod(columns, (clamp(at, 0.0, 1.0) * (size - 1.0) + 0.5) / size, 0.0);
    if (column.x < LIGHT_GRID_WAS_CUT) march_was_cut = true;
    return max(column, 0.0);
}
