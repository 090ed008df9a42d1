// Transmittance by several marches: exp of minus the first one's optical depth, its pivot, times the power series of
// exp of pivot minus true optical depth. Powers are means of the products of all choices among the other marches, each
// unbiased. The number of marches is random, and each term is divided by the odds that it comes. The whole is unbiased,
// whatever the step, but may be negative. After Kettunen, d'Eon, Pantaleoni and Novak, An unbiased ray-marching
// transmittance estimator, ACM Transactions on Graphics 40(4), 2021; the random number of terms by Bhanot and Kennedy,
// Physics Letters 157B, 1985.
Spectrum transmittance_debiased(MediaSpans spans, vec3 origin, vec3 direction, vec2 interval, float step)
{
    const int MEANS = 4;         // beyond that order a term is the one before times one more march
    const int ORDER_LIMIT = 100; // never reached: odds of 1e-158
    // Order k has odds of 1 / (2 k!), so that each term of the series, with its own 1 / k!, counts twice.
    int order = 0;
    while (order < ORDER_LIMIT && random_next() < (order == 0 ? 0.5 : 1.0 / float(order + 1)))
        ++order;
    Spectrum pivot = transmittance_comb(spans, origin, direction, interval, step);
    Spectrum sums[MEANS]; // of products of 1, 2, ... different marches
    for (int k = 0; k < MEANS; ++k)
        sums[k] = spectrum(0.0);
    Spectrum beyond = spectrum(0.0);
    Spectrum last = spectrum(0.0);
    for (int i = 1; i <= order; ++i) {
        Spectrum less = pivot - transmittance_comb(spans, origin, direction, interval, step);
        if (i > MEANS) {
            last = (i == MEANS + 1 ? sums[MEANS - 1] : last) * less;
            beyond += last;
            continue;
        }
        for (int k = MEANS - 1; k > 0; --k)
            sums[k] += less * sums[k - 1];
        sums[0] += less;
    }
    float marches = float(min(order, MEANS));
    float choices = 1.0; // of k among the marches
    for (int k = 1; k <= MEANS; ++k) {
        if (k > order) break;
        choices *= (marches - float(k - 1)) / float(k);
        beyond += sums[k - 1] / choices;
    }
    return segment(pivot).transmittance * (1.0 + 2.0 * beyond);
}
