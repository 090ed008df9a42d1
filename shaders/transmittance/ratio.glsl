// Transmittance as the product over samples that are as far apart as free flights among a majorant of particles.
// Unbiased, and never negative. Novak, Selle and Jarosz, SIGGRAPH Asia 2014.
Spectrum transmittance_ratio(MediaSpans spans, vec3 origin, vec3 direction, vec2 interval)
{
    const float FAINT = 1e-3;
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
        transmittance =
            tracking_thin(transmittance * max(1.0 - media_column_extinction(column) / rate, spectrum(0.0)), FAINT);
        if (spectrum_max(transmittance) <= 0.0) return transmittance;
        at += max(empty, 0.0);
    }
    if (at < interval.y) march_was_cut = true;
    return transmittance;
}
