// Whether light passes media, at random: free flights among a majorant of particles, the first real one ends it. All or
// nothing where there is no colour, and unbiased. Woodcock et al., Argonne report ANL-7050, 1965; colours as in
// integrator/delta.glsl.
Spectrum transmittance_delta(MediaSpans spans, vec3 origin, vec3 direction, vec2 interval)
{
    Spectrum transmittance = spectrum(1.0);
    MediaRay ray = media_ray(origin, direction);
    float at = interval.x;
    for (int iteration = 0; iteration < MARCH_LIMIT && at < interval.y; ++iteration) {
        float edge = media_column_next_edge(spans, at, interval.y);
        float rate = media_column_rate(spans, ray, at, edge);
        float flight = tracking_flight(rate);
        if (at + flight >= edge) {
            at = edge;
            continue;
        }
        at += flight;
        MediaColumn column = media_column_none();
        float empty = media_column_add(column, spans, origin + at * direction, direction, at, 1.0);
        Spectrum extinction = media_column_extinction(column);
        float odds = min(spectrum_mean(transmittance * extinction) / (rate * spectrum_mean(transmittance)), 1.0);
        if (odds > 0.0) {
            if (random_next() < odds) return spectrum(0.0);
            transmittance *= max(1.0 - extinction / rate, spectrum(0.0)) / (1.0 - odds);
        }
        at += max(empty, 0.0);
    }
    if (at < interval.y) march_was_cut = true;
    return transmittance;
}
