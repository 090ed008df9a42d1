// Marches in segments that take the media of their middle as homogeneous. Each is as long as gives about `depth_step`
// of optical depth in its strongest colour, at most `step`. The last segment's extinction is the guess for the next
// one; a segment that proves too thick is shortened and evaluated again, which is cheap beside gathering light. An
// error counts by the light that reaches the camera, so segments grow as the transmittance falls.
struct IntegratorAdaptive { float step, depth_step; };

// Distances are counted from where the media begin, so that a far camera does not cost digits.
void integrator_adaptive(IntegratorAdaptive method, vec3 origin, vec3 direction, vec2 interval, MediaSpans spans,
                         inout Gathered gathered)
{
    const float TOO_THICK = 1.5; // times `wanted`
    const float THIN = 1e-6;     // optical depth below which a segment counts as empty
    const float LEAST_LEFT = 1e-6;
    vec3 entry = origin + interval.x * direction;
    MediaSpans ahead = media_spans_from(spans, interval.x);
    float end = interval.y - interval.x;
    vec2 position = march_resume(vec2(0.0, method.step), end, gathered);
    float at = position.x;
    float next_length = position.y;
    for (int iteration = 0; iteration < MARCH_ITERATIONS && at < end; ++iteration) {
        // The rule is of second order: errors of segments in balance are as the cubes of their lengths.
        float wanted = method.depth_step * pow(max(spectrum_max(gathered.transmittance), LEAST_LEFT), -1.0 / 3.0);
        float half_length = 0.0;
        float depth = 0.0;
        MediaField field;
        // Rays that share a SIMD unit wait here for one another, so that all of them march to the lights together.
        for (; iteration < MARCH_ITERATIONS && at < end; ++iteration) {
            next_length = min(next_length, march_step_limit(entry + at * direction, method.step));
            half_length = 0.5 * min(next_length, media_next_edge(ahead, at, end) - at);
            float middle = at + half_length;
            field = media_field(ahead, entry + middle * direction, direction, middle);
            if (field.distance < 0.0) {
                depth = 2.0 * half_length * spectrum_max(media_extinction(field));
                if (!(depth > TOO_THICK * wanted)) break; // NaN is gathered, and reported
                next_length = 2.0 * half_length * wanted / depth;
            } else {
                at += half_length + max(half_length, field.distance);
                next_length = method.step;
            }
        }
        march_keep(vec2(at, next_length), at >= end, gathered);
        if (at >= end) break;
        gather(gathered, field, entry + (at + half_length) * direction, direction, interval.x + at, 2.0 * half_length);
        at += 2.0 * half_length;
        next_length = min(method.step, 2.0 * half_length * wanted / max(depth, THIN * wanted));
        if (at >= end || gathered_is_over(gathered)) {
            march_keep(vec2(at, next_length), true, gathered);
            break;
        }
    }
    if (at < end && !gathered_is_over(gathered)) march_was_cut = true;
}
