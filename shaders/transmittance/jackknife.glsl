// Transmittance by two marches of their own. exp of minus their mean is too bright by half the mean's variance, each
// march alone by twice as much; twice the one minus the mean of the others has lost that. Terms of third order stay: it
// is biased, but less than a march of as many steps. Quenouille, Biometrika 43, 1956; for transmittances Peters, 2025.
Spectrum transmittance_jackknife(MediaSpans spans, vec3 origin, vec3 direction, vec2 interval, float step)
{
    Spectrum first = transmittance_comb(spans, origin, direction, interval, step);
    Spectrum second = transmittance_comb(spans, origin, direction, interval, step);
    return 2.0 * segment(0.5 * (first + second)).transmittance -
           0.5 * (segment(first).transmittance + segment(second).transmittance);
}
