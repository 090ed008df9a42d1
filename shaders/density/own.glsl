// A density from the job's own code: positive where there is some. Where it is negative, a Lipschitz constant over 0
// makes it a distance: no density is nearer than -value / lipschitz.
struct DensityOwn { float scale, lipschitz; };

// Tests the bits: a compiler may assume that comparisons meet no NaN.
bool density_own_is_nan(float value)
{
    return (floatBitsToUint(value) & 0x7fffffffu) > 0x7f800000u;
}

// A NaN stays NaN, so that the picture shows it.
float density_own_at(DensityOwn density, float value)
{
    return density_own_is_nan(value) ? value : density.scale * max(value, 0.0);
}

float density_own_distance(DensityOwn density, float value)
{
    if (value > 0.0 || density_own_is_nan(value)) return -1.0;
    return density.lipschitz > 0.0 ? -value / density.lipschitz : 0.0;
}
