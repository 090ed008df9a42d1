// Column of the media towards a light as by the midpoint rule, but each segment is evaluated at a random point of it.
// Unbiased. The column of homogeneous media is in it from the start.
struct TransmittanceJittered { float step; };

MediaColumn transmittance_jittered(TransmittanceJittered method, MediaSpans spans, vec3 point, vec3 direction,
                                   float distance)
{
    const float BLACK = 20.0; // optical depth: a transmittance of 2e-9
    vec2 interval = media_column_interval(spans);
    float end = min(distance, interval.y);
    MediaColumn column = media_column_begin(spans, distance);
    float at = max(interval.x, 0.0);
    for (int iteration = 0; iteration < MARCH_LIMIT && at < end; ++iteration) {
        float length = min(method.step, media_column_next_edge(spans, at, end) - at);
        float offset = random_next() * length;
        float empty = media_column_add(column, spans, point + (at + offset) * direction, direction,
                                       at + offset, length);
        if (media_column_depth(column) > BLACK) break;
        // One sum, not two: the last part may be too small to change `at`.
        at += max(length, offset + empty);
    }
    if (at < end && media_column_depth(column) <= BLACK) march_was_cut = true;
    return column;
}
