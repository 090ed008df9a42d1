// Column of the media towards a light by Gauss-Legendre rules of GAUSS_ORDER nodes a segment, from the point to the
// light or to where the media end. The column of homogeneous media is in it from the start.
struct TransmittanceGauss { float step; };

MediaColumn transmittance_gauss(TransmittanceGauss method, MediaSpans spans, vec3 point, vec3 direction, float distance)
{
    const float BLACK = 20.0; // optical depth: a transmittance of 2e-9
    vec2 interval = media_column_interval(spans);
    float end = min(distance, interval.y);
    MediaColumn column = media_column_begin(spans, distance);
    float at = max(interval.x, 0.0);
    for (int iteration = 0; iteration < MARCH_LIMIT && at < end; ++iteration) {
        float length = min(method.step, media_column_next_edge(spans, at, end) - at);
        float next = length;
        for (int i = 0; i < GAUSS_ORDER; ++i) {
            float node = GAUSS_NODES[i] * length;
            float empty = media_column_add(column, spans, point + (at + node) * direction, direction, at + node,
                                           GAUSS_WEIGHTS[i] * length);
            if (i > 0 || empty < length - node) continue;
            next = node + empty;
            break;
        }
        if (media_column_depth(column) > BLACK) break;
        at += next;
    }
    if (at < end && media_column_depth(column) <= BLACK) march_was_cut = true;
    return column;
}
