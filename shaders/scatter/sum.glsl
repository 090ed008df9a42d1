// Sums of the light of many paths. A float drops what is less than half its last digit, and of a million paths that is
// the light of most vertices: 1.6 % of a deep ball's by a quarter of a million. What a sum cannot hold moves its last
// digit as often as that is likely, which keeps the mean: Croci et al., Stochastic rounding, Royal Society Open Science
// 9(3), 2022.

// `sum` with `more`; both are at least 0, and `share` is random, in [0, 1).
float scatter_sum(float sum, float more, float share)
{
    float large = max(sum, more);
    float small = min(sum, more);
    precise float rounded = large + small;
    precise float taken = rounded - large;
    precise float left = small - taken;
    float up = uintBitsToFloat(floatBitsToUint(rounded) + 1u);
    float down = uintBitsToFloat(floatBitsToUint(rounded) - 1u);
    if (left > 0.0) return share * (up - rounded) < left ? up : rounded;
    if (left < 0.0) return share * (rounded - down) < -left ? down : rounded;
    return rounded;
}

vec3 scatter_sum(vec3 sum, vec3 more, float share)
{
    return vec3(scatter_sum(sum.x, more.x, share), scatter_sum(sum.y, more.y, share),
                scatter_sum(sum.z, more.z, share));
}
