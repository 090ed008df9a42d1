// Column of the media towards a light as a plain sum of `steps` samples from the point on; for a light that is
// infinitely far they end where the media do. The column of homogeneous media is in it from the start.
struct TransmittanceRiemann { int steps; };

// A sample whose distance bound covers the next ones is followed by the first one beyond: those between are zero.
MediaColumn transmittance_riemann(TransmittanceRiemann method, MediaSpans spans, vec3 point, vec3 direction,
                                  float distance)
{
    float path_length = distance < FAR_AWAY ? distance : max(media_column_interval(spans).y, 0.0);
    float step = path_length / float(method.steps);
    MediaColumn column = media_column_begin(spans, distance);
    int i = 0;
    for (int iteration = 0; iteration < MARCH_LIMIT && i < method.steps; ++iteration) {
        float at = float(i) * step;
        float empty = media_column_add(column, spans, point + at * direction, direction, at, step);
        i += 1 + int(min(max(empty, 0.0) / max(step, 1e-30), float(method.steps)));
    }
    if (i < method.steps) march_was_cut = true;
    return column;
}
