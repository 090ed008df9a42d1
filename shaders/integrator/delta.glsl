// Analogue tracking: free flights among a majorant of particles, each of which is real or not at random. The first real
// one ends the ray, and only there light is gathered. Unbiased. Woodcock, Murphy, Hemmings and Longworth, Argonne
// report ANL-7050, 1965. Colours share their collisions and are weighted, which keeps the mean transmittance at 1:
// Kutz, Habel, Li and Novak, ACM Transactions on Graphics 36(4), 2017.

// `samples`: the least mean number of samples along the ray, for media that glow without extinction and so have no
// collisions.
struct IntegratorDelta { float samples; };

void integrator_delta(IntegratorDelta method, vec3 origin, vec3 direction, vec2 interval, MediaSpans spans,
                      inout Gathered gathered)
{
    vec3 entry = origin + interval.x * direction;
    MediaSpans ahead = media_spans_from(spans, interval.x);
    MediaRay ray = media_ray(entry, direction);
    float end = interval.y - interval.x;
    float least = method.samples / max(end, 1e-30);
    float at = march_resume(vec2(0.0), end, gathered).x;
    for (int iteration = 0; iteration < MARCH_ITERATIONS && at < end; ++iteration) {
        float rate = 0.0;
        float odds = 0.0; // that the particle is real
        MediaField field;
        // Rays that share a SIMD unit wait here for one another, so that all of them sample lights together.
        for (; iteration < MARCH_ITERATIONS && at < end; ++iteration) {
            float edge = media_next_edge(ahead, at, end);
            rate = media_rate(ahead, ray, at, least, edge);
            float flight = tracking_flight(rate);
            if (at + flight >= edge) {
                at = edge;
                continue;
            }
            at += flight;
            field = media_field(ahead, entry + at * direction, direction, at);
            if (field.distance < 0.0) {
                Spectrum transmittance = gathered_transmittance(gathered);
                Spectrum extinction = media_extinction(field);
                odds = min(spectrum_mean(transmittance * extinction) / (rate * spectrum_mean(transmittance)), 1.0);
                if (odds <= 0.0 || random_next() < odds) break;
                gathered_pass(gathered, transmittance * (max(1.0 - extinction / rate, spectrum(0.0)) / (1.0 - odds)),
                              interval.x + at);
            }
            at += max(field.distance, 0.0);
        }
        if (at >= end || iteration >= MARCH_ITERATIONS) {
            march_keep(vec2(at, 0.0), at >= end, gathered);
            break;
        }
        bool is_end = odds > 0.0;
        gather(gathered, field, entry + at * direction, direction,
               gathered_transmittance(gathered) / (rate * (is_end ? odds : 1.0)));
        if (is_end) gathered_pass(gathered, spectrum(0.0), interval.x + at);
        march_keep(vec2(at, 0.0), is_end, gathered);
        if (is_end) break;
    }
    if (at < end && !gathered_is_over(gathered)) march_was_cut = true;
}
