// Column of the media towards a light by the midpoint rule, from the point to the light or to where the media end. The
// column of homogeneous media is in it from the start.
struct TransmittanceMidpoint { float step; };

MediaColumn transmittance_midpoint(TransmittanceMidpoint method, MediaSpans spans, vec3 point, vec3 direction,
                                   float distance)
{
    const float BLACK = 20.0; // optical depth: a transmittance of 2e-9
    vec2 interval = media_column_interval(spans);
    float end = min(distance, interval.y);
    MediaColumn column = media_column_begin(spans, distance);
    float at = max(interval.x, 0.0);
    for (int iteration = 0; iteration < MARCH_LIMIT && at < end; ++iteration) {
        float half_length = 0.5 * min(method.step, media_column_next_edge(spans, at, end) - at);
        float middle = at + half_length;
        float empty = media_column_add(column, spans, point + middle * direction, direction, middle, 2.0 * half_length);
        if (media_column_depth(column) > BLACK) break;
        // One sum, not two: a last half may be too small to change `at`.
        at += half_length + max(half_length, empty);
    }
    if (at < end && media_column_depth(column) <= BLACK) march_was_cut = true;
    return column;
}
