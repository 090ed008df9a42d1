// Scattering by particles far smaller than the wavelength, 3 / (16 pi) (1 + cos^2); normalized over the sphere.
float phase_rayleigh(float cos_theta)
{
    return 0.75 * INV_4PI * (1.0 + cos_theta * cos_theta);
}
