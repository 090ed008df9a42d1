// Column of the media towards a light by the midpoint rule, from the point to the light or to where the media end.
struct TransmittanceMidpoint { float step; };

MediaColumn transmittance_midpoint(TransmittanceMidpoint method, vec3 point, vec3 direction, float distance)
{
    const float BLACK = 20.0; // optical depth: 2e-9 of the light is left
    float end = min(distance, ball_exit(media_ball(), point, direction));
    MediaColumn column = media_column_empty();
    float at = 0.0;
    for (int turn = 0; turn < MARCH_LIMIT && at < end; ++turn) {
        float half_length = 0.5 * min(method.step, end - at);
        MediaField field = media_field(point + (at + half_length) * direction);
        media_column_add(column, field, 2.0 * half_length);
        if (media_column_depth(column) > BLACK) break;
        // Nothing is within a field's distance. One sum, not two: a last half may be too small to change `at`.
        at += half_length + max(half_length, media_field_distance(field));
    }
    if (at < end && media_column_depth(column) <= BLACK) march_was_cut = true;
    return column;
}
