// Column of the media towards a light from segments that take the media of their middle as homogeneous. Each is as long
// as gives about `depth_step` of optical depth in its strongest colour, at most `step`. The column of homogeneous media
// is in it from the start. An error counts by the light that gets through, so segments grow as the transmittance falls.
struct TransmittanceAdaptive { float step, depth_step; };

MediaColumn transmittance_adaptive(TransmittanceAdaptive method, MediaSpans spans, vec3 point, vec3 direction,
                                   float distance)
{
    const float BLACK = 20.0;    // optical depth: a transmittance of 2e-9
    const float TOO_THICK = 2.0; // times `wanted`
    const float THIN = 1e-6;
    vec2 interval = media_column_interval(spans);
    float end = min(distance, interval.y);
    MediaColumn column = media_column_begin(spans, distance);
    float at = max(interval.x, 0.0);
    float reach = method.step;
    for (int iteration = 0; iteration < MARCH_LIMIT && at < end; ++iteration) {
        float half_length = 0.5 * min(reach, media_column_next_edge(spans, at, end) - at);
        float middle = at + half_length;
        float wanted = method.depth_step * exp(media_column_depth(column) * (1.0 / 3.0));
        MediaColumn rate = media_column_none();
        float empty = media_column_add(rate, spans, point + middle * direction, direction, middle, 1.0);
        float depth = 2.0 * half_length * media_column_thickness(rate);
        float fitting = 2.0 * half_length * wanted / max(depth, THIN * wanted);
        reach = empty < 0.0 ? min(method.step, fitting) : method.step;
        if (depth > TOO_THICK * wanted) continue;
        media_column_extend(column, rate, 2.0 * half_length);
        if (media_column_depth(column) > BLACK) break;
        // One sum, not two: a last half may be too small to change `at`.
        at += half_length + max(half_length, empty);
    }
    if (at < end && media_column_depth(column) <= BLACK) march_was_cut = true;
    return column;
}
