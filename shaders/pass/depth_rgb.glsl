// How far into a homogeneous segment the mean transmittance falls to one half; halving finds it in a sum of exponentials.
float depth_half(vec3 before, vec3 sigma_t, float length)
{
    float low = 0.0;
    float high = length;
    for (int i = 0; i < 24; ++i) {
        float middle = 0.5 * (low + high);
        if (spectrum_mean(before * exp(-sigma_t * middle)) > 0.5) low = middle;
        else high = middle;
    }
    return high;
}
