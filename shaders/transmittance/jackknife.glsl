// What media leave of light by two marches of their own: exp of their mean is too bright by half the mean's variance, each
// alone by twice as much, and twice the one less the mean of the others has lost that. Terms of third order stay, so it is not
// right on the average, but nearer than a march of as many steps. Quenouille, Biometrika 43, 1956; for transmittances Peters,
// 2025.
Spectrum transmittance_jackknife(MediaSpans spans, vec3 origin, vec3 direction, vec2 interval, float step)
{
    Spectrum first = transmittance_comb(spans, origin, direction, interval, step);
    Spectrum second = transmittance_comb(spans, origin, direction, interval, step);
    return 2.0 * segment(0.5 * (first + second)).transmittance -
           0.5 * (segment(first).transmittance + segment(second).transmittance);
}
