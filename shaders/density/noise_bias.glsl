// Moves the middle of [0, 1] and leaves its ends: `exponent` is (1 - bias) / (1 + bias).
float density_noise_bias(float value, float exponent)
{
    return value > 0.0 ? pow(value, exponent) : 0.0;
}
