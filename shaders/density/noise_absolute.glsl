// Turbulence: each octave's absolute value, which leaves creases where the octave is zero.
float density_noise_absolute(float octave)
{
    return abs(octave);
}
