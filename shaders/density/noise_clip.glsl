// A sum of octaves without its negative half.
float density_noise_clip(float sum)
{
    return max(sum, 0.0);
}
