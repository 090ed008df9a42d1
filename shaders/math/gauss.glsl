// Light and extinction of a segment from what its nodes have by Gauss and Legendre's rule. What is taken away before a node
// is integrated from all nodes to the same order: Butcher, Implicit Runge-Kutta Processes, Mathematics of Computation 18, 1964.

// The light that leaves the segment; `optical_depth` becomes the whole of it. The sum of sources is scaled by what the
// same sum makes of the extinction, which is known: 1 - exp(-x). So any mix of media with one albedo comes out exactly.
// Where that scale is far from 1 the segment is too thick, or too rough, for the rule: then it is as if made of pieces,
// one a node, each homogeneous, which neither gain nor lose light.
Spectrum gauss_segment(Spectrum sigma_t[GAUSS_ORDER], Spectrum source[GAUSS_ORDER], float length,
                       out Spectrum optical_depth)
{
    const float FAR_FROM_1 = 0.1;
    optical_depth = spectrum(0.0);
    for (int i = 0; i < GAUSS_ORDER; ++i)
        optical_depth += GAUSS_WEIGHTS[i] * length * sigma_t[i];
    Spectrum light = spectrum(0.0);
    Spectrum taken = spectrum(0.0);
    Spectrum pieces = spectrum(0.0);
    Spectrum passed = spectrum(1.0);
    for (int i = 0; i < GAUSS_ORDER; ++i) {
        Spectrum before = spectrum(0.0);
        for (int k = 0; k < GAUSS_ORDER; ++k)
            before += GAUSS_PARTIALS[i * GAUSS_ORDER + k] * length * sigma_t[k];
        // What oscillates within a segment may come out negative.
        Spectrum share = GAUSS_WEIGHTS[i] * length * exp(-clamp(before, spectrum(0.0), optical_depth));
        light += share * source[i];
        taken += share * sigma_t[i];
        Segment piece = segment(GAUSS_WEIGHTS[i] * length * sigma_t[i]);
        pieces += passed * piece.escape * GAUSS_WEIGHTS[i] * length * source[i];
        passed *= piece.transmittance;
    }
    Spectrum scale = optical_depth * segment(optical_depth).escape / max(taken, spectrum(1e-30));
    return spectrum_select(light * scale, pieces, abs(scale - 1.0), FAR_FROM_1);
}
