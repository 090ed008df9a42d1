// How far into a homogeneous segment the transmittance falls to one half.
float depth_half(float before, float sigma_t, float length)
{
    return min(log(2.0 * before) / max(sigma_t, 1e-30), length);
}
