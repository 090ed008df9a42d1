// Marches in segments of `step`, each evaluated at a random point for its source. The transmittances of the part before
// the point and of the part behind it are estimates of their own. Products of independent estimates: where each is
// unbiased, so is the whole, whatever the step.
struct IntegratorEstimated { float step; };

// Beyond a segment, only space that the media's bounds show to be empty is left out. Distances are counted from where
// the media begin.
void integrator_estimated(IntegratorEstimated method, vec3 origin, vec3 direction, vec2 interval, MediaSpans spans,
                          inout Gathered gathered)
{
    vec3 entry = origin + interval.x * direction;
    MediaSpans ahead = media_spans_from(spans, interval.x);
    float end = interval.y - interval.x;
    float at = march_resume(vec2(0.0), end, gathered).x;
    for (int iteration = 0; iteration < MARCH_ITERATIONS && at < end; ++iteration) {
        float length = min(method.step, media_next_edge(ahead, at, end) - at);
        float offset = random_next() * length;
        vec3 point = entry + (at + offset) * direction;
        MediaField field = media_field(ahead, point, direction, at + offset);
        Spectrum transmittance = gathered_transmittance(gathered);
        int part = 0;
        for (; part < 2; ++part) {
            vec2 piece = at + (part == 0 ? vec2(0.0, offset) : vec2(offset, length));
            transmittance *= media_transmittance_estimate(ahead, entry, direction, piece, method.step);
            if (part == 0 && field.distance < 0.0) gather(gathered, field, point, direction, transmittance * length);
        }
        if (part < 2) march_was_cut = true;
        gathered_pass(gathered, transmittance, interval.x + at + length);
        at += max(length, offset + field.distance);
        bool is_end = at >= end || gathered_is_over(gathered);
        march_keep(vec2(at, 0.0), is_end, gathered);
        if (is_end) break;
    }
    if (at < end && !gathered_is_over(gathered)) march_was_cut = true;
}
