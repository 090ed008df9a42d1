// Segments as the midpoint method's, but next to a point light, whose light rises and falls within a step, shorter ones: three
// tenths of how far the light is away where they begin, as long as that is more than a small part of a step.
struct IntegratorNear { float step; };

// Distances are counted from where the media begin, so that a far camera leaves them their digits.
void integrator_near(IntegratorNear method, vec3 origin, vec3 direction, vec2 interval, MediaSpans spans,
                     inout Gathered gathered)
{
    const float LEAST = 1.0 / 256.0; // of a step
    vec3 entry = origin + interval.x * direction;
    MediaSpans ahead = media_spans_from(spans, interval.x);
    float end = interval.y - interval.x;
    float at = 0.0;
    for (int turn = 0; turn < MARCH_LIMIT && at < end; ++turn) {
        float half_length = 0.0;
        MediaField field;
        // Rays that share a SIMD unit wait here for one another, so that all of them gather together.
        for (; turn < MARCH_LIMIT && at < end; ++turn) {
            float away = lights_distance(entry + at * direction);
            float reach = clamp(0.3 * away, LEAST * method.step, method.step);
            half_length = 0.5 * min(reach, media_next_edge(ahead, at, end) - at);
            float middle = at + half_length;
            field = media_field(ahead, entry + middle * direction, direction, middle);
            if (field.distance < 0.0) break;
            at += half_length + max(half_length, field.distance);
        }
        if (at >= end) break;
        gather(gathered, field, entry + (at + half_length) * direction, direction, interval.x + at, 2.0 * half_length);
        at += 2.0 * half_length;
        if (gathered_is_over(gathered)) break;
    }
    if (at < end && !gathered_is_over(gathered)) march_was_cut = true;
}
