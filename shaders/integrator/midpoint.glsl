// Segments of `step`, the last one ending exactly where the interval does; each is homogeneous with the media of its
// middle, integrated exactly. Space that the media's distance bound shows to be empty is stepped over.
struct IntegratorMidpoint { float step; };

void integrator_midpoint(IntegratorMidpoint method, vec3 origin, vec3 direction, vec2 interval, inout Gathered gathered)
{
    vec3 entry = origin + interval.x * direction;
    float end = interval.y - interval.x;
    float at = 0.0;
    for (int turn = 0; turn < MARCH_LIMIT && at < end; ++turn) {
        float half_length = 0.0;
        MediaField field;
        // Rays that share a SIMD unit wait here for one another, so that all of them march to the lights together.
        for (; turn < MARCH_LIMIT && at < end; ++turn) {
            half_length = 0.5 * min(method.step, end - at);
            field = media_field(entry + (at + half_length) * direction);
            float distance = media_field_distance(field);
            if (distance < 0.0) break;
            at += half_length + max(half_length, distance);
        }
        if (at >= end) break;
        gather(gathered, field, entry + (at + half_length) * direction, direction, interval.x + at, 2.0 * half_length);
        at += 2.0 * half_length;
        if (gathered_is_over(gathered)) break;
    }
    if (at < end && !gathered_is_over(gathered)) march_was_cut = true;
}
