// Draws the angle of scattering by Rayleigh's phase function: the root of mu^3 + 3 mu = 8 share - 4, by Cardano.

// Returns 1 - cos of a random angle to the direction of travel, for `share` in [0, 1).
float scatter_rayleigh(float share)
{
    float half_right = 4.0 * share - 2.0;
    float root = pow(abs(half_right) + sqrt(half_right * half_right + 1.0), 1.0 / 3.0);
    float cos_theta = sign(half_right) * (root - 1.0 / root);
    return 1.0 - clamp(cos_theta, -1.0, 1.0);
}
