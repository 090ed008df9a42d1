// A segment of constant extinction, by its optical depth: its transmittance, and the share of its own source's light
// that leaves it forwards: integral of exp(-x s) ds over s in [0, 1] = (1 - exp(-x)) / x.
struct Segment { Spectrum transmittance, escape; };

// Below the limit the series of the escape is exact to the last digit of a float, where 1 - exp(-x) would cancel. The
// transmittance follows from it, so that extinction and source in balance add up exactly.
Segment segment(Spectrum optical_depth)
{
    const float SERIES_LIMIT = 0.5;
    Spectrum x = optical_depth;
    Spectrum series = 1.0 - x * (1.0 / 2.0 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0
                      - x * (1.0 / 720.0 - x * (1.0 / 5040.0))))));
    Spectrum thick = exp(-x);
    Spectrum escape = spectrum_select(series, (1.0 - thick) / max(x, spectrum(SERIES_LIMIT)), x, SERIES_LIMIT);
    return Segment(spectrum_select(1.0 - x * series, thick, x, SERIES_LIMIT), escape);
}
