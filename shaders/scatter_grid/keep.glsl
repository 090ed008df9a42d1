// Prepares a node's mean so that linear interpolation between nodes is right on the average, as light_grid/keep.glsl
// does: minus a twelfth of its second differences. Light falls off to all sides, so that chords lie below it.
// `sets` of values lie one behind the other along z. Where walks were cut, alpha is so far below 0 that no neighbour's
// hides it.
const float SCATTER_GRID_UNNEEDED = 2e6; // as in walk.glsl: such a node has no value

// A node's mean is the sum of its lanes' texels, one behind the other along x. Alpha is below 0 where walks were cut.
vec4 scatter_grid_mean(sampler3D means, ivec3 at)
{
    vec4 sum = vec4(0.0);
    for (int lane = 0; lane < SCATTER_GRID_LANES; ++lane) {
        vec4 part = texelFetch(means, ivec3(at.x * SCATTER_GRID_LANES + lane, at.yz), 0);
        sum = vec4(sum.rgb + part.rgb, part.a < 0.0 ? -1e9 : sum.a + part.a);
    }
    return sum;
}

vec4 scatter_grid_keep(sampler3D means, ivec3 at, int sets)
{
    ivec3 size = textureSize(means, 0) / ivec3(SCATTER_GRID_LANES, 1, 1);
    int layers = size.z / sets;
    ivec3 place = ivec3(at.xy, at.z % layers);
    ivec3 last = ivec3(size.xy, layers) - 1;
    vec4 middle = scatter_grid_mean(means, at);
    vec4 sum = vec4(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        ivec3 next = ivec3(0);
        next[axis] = place[axis] > 0 && place[axis] < last[axis] ? 1 : 0;
        vec4 before = scatter_grid_mean(means, at - next);
        vec4 after = scatter_grid_mean(means, at + next);
        if (max(before.a, after.a) < SCATTER_GRID_UNNEEDED) sum += before + after - 2.0 * middle;
    }
    return middle.a < 0.0 ? vec4(0.0, 0.0, 0.0, -1e6) : vec4(max(middle.rgb - sum.rgb / 12.0, 0.0), 0.0);
}
