// Marches in segments of `step` as the midpoint method, but evaluates each at a random point of it, so that errors of
// coarse steps are noise and not bands. Cook, Stochastic Sampling in Computer Graphics, ACM Transactions on Graphics
// 5(1), 1986.
struct IntegratorJittered { float step; };

// Space that is empty from the point on is left out of the next segments. That is unbiased: whatever the point, a
// segment's mean is its own. Distances are counted from where the media begin.
void integrator_jittered(IntegratorJittered method, vec3 origin, vec3 direction, vec2 interval, MediaSpans spans,
                         inout Gathered gathered)
{
    vec3 entry = origin + interval.x * direction;
    MediaSpans ahead = media_spans_from(spans, interval.x);
    float end = interval.y - interval.x;
    float at = march_resume(vec2(0.0), end, gathered).x;
    for (int iteration = 0; iteration < MARCH_ITERATIONS && at < end; ++iteration) {
        float length = 0.0;
        float offset = 0.0;
        MediaField field;
        // Rays that share a SIMD unit wait here for one another, so that all of them march to the lights together.
        for (; iteration < MARCH_ITERATIONS && at < end; ++iteration) {
            length = min(march_step_limit(entry + at * direction, method.step), media_next_edge(ahead, at, end) - at);
            offset = random_next() * length;
            field = media_field(ahead, entry + (at + offset) * direction, direction, at + offset);
            if (field.distance < 0.0) break;
            at += max(length, offset + field.distance);
        }
        if (at >= end || iteration >= MARCH_ITERATIONS) {
            march_keep(vec2(at, 0.0), at >= end, gathered);
            break;
        }
        gather(gathered, field, entry + (at + offset) * direction, direction, interval.x + at, length, offset);
        at += length;
        bool is_end = at >= end || gathered_is_over(gathered);
        march_keep(vec2(at, 0.0), is_end, gathered);
        if (is_end) break;
    }
    if (at < end && !gathered_is_over(gathered)) march_was_cut = true;
}
