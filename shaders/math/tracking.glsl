// Free flights: the distance to the first particle, among `rate` of them a metre.

const float TRACKING_SAMPLES = 4.0; // the least mean number along a ray's path through media

// Returns a random distance, exponentially distributed; FAR_AWAY without particles. Random numbers have 24 bits, so
// that no flight is longer than 16.6 mean ones: 6e-8 of the light behind is lost.
float tracking_flight(float rate)
{
    return rate > 0.0 ? -log(1.0 - random_next()) / rate : FAR_AWAY;
}

// Light that is fainter than `faint` ends at random, and is weighted where it goes on, which keeps the mean.
Spectrum tracking_thin(Spectrum transmittance, float faint)
{
    float most = spectrum_max(transmittance);
    if (most >= faint) return transmittance;
    return random_next() * faint < most ? transmittance * (faint / most) : spectrum(0.0);
}
