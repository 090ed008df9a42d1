// The radiance about a node, weighed by the phase function, from what particles left in its cell; prepared so that
// linear interpolation between nodes is right on the average, as in keep.glsl. The mean of a cell is itself a 24th of
// the second differences above the node's value: an eighth in all.

vec3 scatter_sum_at(ivec3 at, ivec3 size)
{
    int first = 2 + 2 * SCATTER_GRID_CHANNELS * (at.x + size.x * (at.y + size.y * at.z));
    vec3 sum = vec3(0.0);
    for (int channel = 0; channel < SCATTER_GRID_CHANNELS; ++channel) {
        int low = first + 2 * channel;
        sum[channel] = float(cache_sums[low]) + 4294967296.0 * float(cache_sums[low + 1]);
    }
    return SCATTER_GRID_CHANNELS == 1 ? sum.rrr : sum;
}

// `states` is what the particles' program left, `sent` their number.
vec4 scatter_grid_keep(sampler3D states, ivec3 at, ivec3 size, int sets, vec3 cell, float sent)
{
    if (cache_sums[0] != 0u) return vec4(0.0, 0.0, 0.0, -1e6);
    int layers = size.z / sets;
    ivec3 place = ivec3(at.xy, at.z % layers);
    ivec3 last = ivec3(size.xy, layers) - 1;
    vec3 middle = scatter_sum_at(at, size);
    vec3 sum = vec3(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        ivec3 next = ivec3(0);
        next[axis] = place[axis] > 0 && place[axis] < last[axis] ? 1 : 0;
        sum += scatter_sum_at(at - next, size) + scatter_sum_at(at + next, size) - 2.0 * middle;
    }
    float power = texelFetch(states, ivec3(0, 0, 3), 0).a;
    float unit = power * INV_4PI / (sent * 1048576.0 * cell.y * cell.z);
    return vec4(max(middle - sum / 8.0, 0.0) * unit, 0.0);
}
