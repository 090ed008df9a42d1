// Draws the angle of scattering by the phase function of Henyey and Greenstein: its integral has an inverse.

// Returns 1 - cos of a random angle to the direction of travel, for `share` in [0, 1). Nothing cancels near the peak,
// and g = 0 needs no case of its own.
float scatter_henyey_greenstein(float g, float share)
{
    float size = abs(g);
    float reach = 1.0 - size + 2.0 * size * share;
    float less = (1.0 - size) * (1.0 - size) * (1.0 - share) * (1.0 + size + reach) / (reach * reach);
    return g < 0.0 ? 2.0 - less : less;
}
