// Free flights: how far light comes before it meets a particle, among `rate` of them a metre.

const float TRACKING_SAMPLES = 4.0; // on a ray's way through media, on the average and at least

// Exponential, by lot; a stretch without particles is passed. Random numbers have 24 bits, so that no flight is longer than
// 16.6 mean ones: of what lies behind more, 6e-8 is lost.
float tracking_flight(float rate)
{
    return rate > 0.0 ? -log(1.0 - random_next()) / rate : FAR_AWAY;
}

// Light that is fainter than `faint` ends by lot, and what goes on stands for it: the mean stays what it is.
Spectrum tracking_thin(Spectrum transmittance, float faint)
{
    float most = spectrum_max(transmittance);
    if (most >= faint) return transmittance;
    return random_next() * faint < most ? transmittance * (faint / most) : spectrum(0.0);
}
