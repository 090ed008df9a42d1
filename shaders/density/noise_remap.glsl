// A sum of octaves moved from [-1, 1] to [0, 1]; below that is empty.
float density_noise_remap(float sum)
{
    return max(0.5 + 0.5 * sum, 0.0);
}
