// Column of the media towards a light as a plain sum of `steps` samples from the point on; one for a light beyond
// everything ends where the media do.
struct TransmittanceRiemann { int steps; };

// A sample whose distance bound covers the next ones is followed by the first one outside of it: those between are zero.
MediaColumn transmittance_riemann(TransmittanceRiemann method, vec3 point, vec3 direction, float distance)
{
    float way = distance < FAR_AWAY ? distance : ball_exit(media_ball(), point, direction);
    float step = way / float(method.steps);
    MediaColumn column = media_column_empty();
    int i = 0;
    for (int turn = 0; turn < MARCH_LIMIT && i < method.steps; ++turn) {
        MediaField field = media_field(point + (float(i) * step) * direction);
        media_column_add(column, field, step);
        i += 1 + int(min(max(media_field_distance(field), 0.0) / max(step, 1e-30), float(method.steps)));
    }
    if (i < method.steps) march_was_cut = true;
    return column;
}
