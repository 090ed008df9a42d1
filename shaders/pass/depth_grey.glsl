// How far into a homogeneous segment the mean transmittance falls to one half, with all colours alike.
float depth_half(Spectrum before, Spectrum sigma_t, float length)
{
    return min(log(2.0 * spectrum_mean(before)) / max(spectrum_mean(sigma_t), 1e-30), length);
}
