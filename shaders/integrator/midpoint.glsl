// Marches in segments of `step`, shorter next to point lights; the last one before an edge of a medium's span ends
// exactly there. Each is homogeneous with the media of its middle, integrated exactly. Space that the media's bounds
// show to be empty is stepped over.
struct IntegratorMidpoint { float step; };

// Distances are counted from where the media begin, so that a far camera does not cost digits.
void integrator_midpoint(IntegratorMidpoint method, vec3 origin, vec3 direction, vec2 interval, MediaSpans spans,
                         inout Gathered gathered)
{
    vec3 entry = origin + interval.x * direction;
    MediaSpans ahead = media_spans_from(spans, interval.x);
    float end = interval.y - interval.x;
    float at = march_resume(vec2(0.0), end, gathered).x;
    for (int iteration = 0; iteration < MARCH_ITERATIONS && at < end; ++iteration) {
        float half_length = 0.0;
        MediaField field;
        // Rays that share a SIMD unit wait here for one another, so that all of them march to the lights together.
        for (; iteration < MARCH_ITERATIONS && at < end; ++iteration) {
            float limit = march_step_limit(entry + at * direction, method.step);
            half_length = 0.5 * min(limit, media_next_edge(ahead, at, end) - at);
            float middle = at + half_length;
            field = media_field(ahead, entry + middle * direction, direction, middle);
            if (field.distance < 0.0) break;
            at += half_length + max(half_length, field.distance);
        }
        march_keep(vec2(at, 0.0), at >= end, gathered);
        if (at >= end) break;
        gather(gathered, field, entry + (at + half_length) * direction, direction, interval.x + at, 2.0 * half_length);
        at += 2.0 * half_length;
        if (at >= end || gathered_is_over(gathered)) {
            march_keep(vec2(at, 0.0), true, gathered);
            break;
        }
    }
    if (at < end && !gathered_is_over(gathered)) march_was_cut = true;
}
