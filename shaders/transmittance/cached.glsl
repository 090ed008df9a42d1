// Columns of media towards a light from its grid, a channel a medium, linearly between nodes: those are the texels' centres.
// Where a driver's filter has weights of 8 bits it errs by less than a 500th of what a cell holds.
const float LIGHT_GRID_WAS_CUT = -1e5; // far below what keeping makes of a column

vec4 transmittance_cached(sampler3D columns, vec3 at)
{
    vec3 size = vec3(textureSize(columns, 0));
    vec4 column = textureLod(columns, (clamp(at, 0.0, 1.0) * (size - 1.0) + 0.5) / size, 0.0);
    if (column.x < LIGHT_GRID_WAS_CUT) march_was_cut = true;
    return max(column, 0.0);
}
