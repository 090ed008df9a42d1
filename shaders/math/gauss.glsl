// Light and extinction of a segment from what its nodes have by Gauss and Legendre's rule. What is taken away before a node
// is integrated from all nodes to the same order: Butcher, Implicit Runge-Kutta Processes, Mathematics of Computation 18, 1964.

// The light that leaves the segment; `optical_depth` becomes the whole of it. The sum of sources is scaled by what the
// same sum makes of the extinction, which is known: 1 - exp(-x). So any mix of media with one albedo comes out exactly,
// however long the segment, and light is not gained.
Spectrum gauss_segment(Spectrum sigma_t[GAUSS_ORDER], Spectrum source[GAUSS_ORDER], float length,
                       out Spectrum optical_depth)
{
    const float THIN = 1e-6; // optical depth: nothing to scale
    const float LARGEST_SCALE = 2.0;
    Spectrum before[GAUSS_ORDER];
    optical_depth = spectrum(0.0);
    for (int i = 0; i < GAUSS_ORDER; ++i)
        optical_depth += GAUSS_WEIGHTS[i] * length * sigma_t[i];
    Spectrum least = optical_depth;
    for (int i = 0; i < GAUSS_ORDER; ++i) {
        before[i] = spectrum(0.0);
        for (int k = 0; k < GAUSS_ORDER; ++k)
            before[i] += GAUSS_PARTIALS[i * GAUSS_ORDER + k] * length * sigma_t[k];
        // What oscillates within a segment may come out negative.
        before[i] = clamp(before[i], spectrum(0.0), optical_depth);
        least = min(least, before[i]);
    }
    Spectrum light = spectrum(0.0);
    Spectrum taken = spectrum(0.0);
    for (int i = 0; i < GAUSS_ORDER; ++i) {
        Spectrum share = GAUSS_WEIGHTS[i] * length * exp(least - before[i]);
        light += share * source[i];
        taken += share * sigma_t[i];
    }
    Spectrum scale = optical_depth * segment(optical_depth).escape / max(taken, spectrum(1e-30));
    return light * spectrum_select(spectrum(1.0), min(scale, spectrum(LARGEST_SCALE)), optical_depth, THIN);
}
