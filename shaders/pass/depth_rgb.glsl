// How far into a homogeneous segment the mean transmittance falls to one half. A sum of falling exponentials is convex,
// so that Newton's steps from its beginning never go too far.

// Drivers unroll loops of fewer iterations, and then all rays run them to the end, though few have a depth.
const int DEPTH_ITERATION_LIMIT = 64;

float depth_half(vec3 before, vec3 sigma_t, float length)
{
    float at = 0.0;
    for (int i = 0; i < DEPTH_ITERATION_LIMIT; ++i) {
        vec3 transmittance = before * exp(-sigma_t * at);
        float step = (spectrum_mean(transmittance) - 0.5) / max(spectrum_mean(transmittance * sigma_t), 1e-30);
        at += step;
        if (step <= 1e-6 * at) break;
    }
    return min(at, length);
}
