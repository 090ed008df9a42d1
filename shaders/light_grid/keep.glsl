// Prepares columns at a grid's nodes so that linear interpolation between them is right on the average: each minus a
// twelfth of its second differences. Condat, Blu and Unser, Beyond Interpolation: Optimal Reconstruction by
// Quasi-Interpolation, ICIP 2005. Nodes at the grid's faces have no differences across these.
vec4 light_grid_keep(sampler3D columns, ivec3 at)
{
    ivec3 last = textureSize(columns, 0) - 1;
    vec4 middle = texelFetch(columns, at, 0);
    vec4 sum = vec4(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        ivec3 next = ivec3(0);
        next[axis] = at[axis] > 0 && at[axis] < last[axis] ? 1 : 0;
        sum += texelFetch(columns, at - next, 0) + texelFetch(columns, at + next, 0) - 2.0 * middle;
    }
    return middle.x < 0.0 ? middle : middle - sum / 12.0;
}
