// Weighted tracking: samples are as far apart as free flights among a majorant of particles, of which there are more
// than real ones everywhere. Each sample gathers light, and takes away the share of particles that are real. Unbiased.
// Galtier, Blanco, Caliot, Coustet, Dauchet, El Hafi, Eymet, Fournier, Gautrais, Khuong, Piaud and Terree, Journal of
// Quantitative Spectroscopy and Radiative Transfer 125, 2013; Novak, Selle and Jarosz, SIGGRAPH Asia 2014.

// `samples`: the least mean number of samples along a ray's path through media, however thin they are.
struct IntegratorRatio { float samples; };

// Distances are counted from where the media begin. A sample does not depend on those before, so a ray can resume
// anywhere.
void integrator_ratio(IntegratorRatio method, vec3 origin, vec3 direction, vec2 interval, MediaSpans spans,
                      inout Gathered gathered)
{
    const float FAINT = 1e-5;
    vec3 entry = origin + interval.x * direction;
    MediaSpans ahead = media_spans_from(spans, interval.x);
    MediaRay ray = media_ray(entry, direction);
    float end = interval.y - interval.x;
    float least = method.samples / max(end, 1e-30);
    float at = march_resume(vec2(0.0), end, gathered).x;
    for (int iteration = 0; iteration < MARCH_ITERATIONS && at < end; ++iteration) {
        float rate = 0.0;
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
            if (field.distance < 0.0) break;
            at += field.distance;
        }
        if (at >= end || iteration >= MARCH_ITERATIONS) {
            march_keep(vec2(at, 0.0), at >= end, gathered);
            break;
        }
        Spectrum transmittance = gathered_transmittance(gathered);
        gather(gathered, field, entry + at * direction, direction, transmittance / rate);
        gathered_pass(gathered,
                      tracking_thin(transmittance * max(1.0 - media_extinction(field) / rate, spectrum(0.0)), FAINT),
                      interval.x + at);
        bool is_end = gathered_is_over(gathered);
        march_keep(vec2(at, 0.0), is_end, gathered);
        if (is_end) break;
    }
    if (at < end && !gathered_is_over(gathered)) march_was_cut = true;
}
