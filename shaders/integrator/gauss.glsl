// Marches in segments of `step`, shorter next to point lights; the last one before an edge of a medium's span ends
// exactly there. Each is evaluated at the nodes of a Gauss-Legendre rule: of order 2 GAUSS_ORDER where all is smooth.
// Segments that the media's bounds show to be empty are stepped over.
struct IntegratorGauss { float step; };

// Distances are counted from where the media begin, so that a far camera does not cost digits.
void integrator_gauss(IntegratorGauss method, vec3 origin, vec3 direction, vec2 interval, MediaSpans spans,
                      inout Gathered gathered)
{
    vec3 entry = origin + interval.x * direction;
    MediaSpans ahead = media_spans_from(spans, interval.x);
    float end = interval.y - interval.x;
    float at = march_resume(vec2(0.0), end, gathered).x;
    for (int iteration = 0; iteration < MARCH_ITERATIONS && at < end; ++iteration) {
        float length = 0.0;
        MediaField field;
        // Rays that share a SIMD unit wait here for one another, so that all of them march to the lights together.
        for (; iteration < MARCH_ITERATIONS && at < end; ++iteration) {
            length = min(march_step_limit(entry + at * direction, method.step), media_next_edge(ahead, at, end) - at);
            float first = GAUSS_NODES[0] * length;
            field = media_field(ahead, entry + (at + first) * direction, direction, at + first);
            if (field.distance < length - first) break;
            at += max(length, first + field.distance);
        }
        march_keep(vec2(at, 0.0), at >= end, gathered);
        if (at >= end) break;
        Spectrum sigma_t[GAUSS_ORDER];
        Spectrum source[GAUSS_ORDER];
        for (int i = 0; i < GAUSS_ORDER; ++i) {
            float position = at + GAUSS_NODES[i] * length;
            vec3 point = entry + position * direction;
            if (i > 0) field = media_field(ahead, point, direction, position);
            gather_node(gathered, field, point, direction, length, position - at, sigma_t[i], source[i]);
        }
        Spectrum optical_depth;
        Spectrum light = gauss_segment(sigma_t, source, length, optical_depth);
        gather_segment(gathered, light, optical_depth, interval.x + at, length);
        at += length;
        if (at >= end || gathered_is_over(gathered)) {
            march_keep(vec2(at, 0.0), true, gathered);
            break;
        }
    }
    if (at < end && !gathered_is_over(gathered)) march_was_cut = true;
}
