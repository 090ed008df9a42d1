// Light and extinction of a segment from its nodes, by a Gauss-Legendre rule. The optical depth before a node is
// integrated from all nodes to the same order: Butcher, Implicit Runge-Kutta Processes, Mathematics of Computation 18,
// 1964.

// Returns the light that leaves the segment; `optical_depth` is set to its whole optical depth. The sum of sources is
// scaled by the known integral of the extinction, 1 - exp(-x), over the rule's sum for it. So any mix of media with one
// albedo is exact. Where that scale is far from 1 the segment is too thick, or too rough, for the rule: then it counts
// as homogeneous pieces, one a node, which neither gain nor lose light.
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
        // An extinction that oscillates within a segment may give a negative sum.
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
