// Optical depth by a comb of equal steps of at most `step`, all shifted by one random share of a step: unbiased,
// whatever the step.
Spectrum transmittance_comb(MediaSpans spans, vec3 origin, vec3 direction, vec2 interval, float step)
{
    float count = max(ceil((interval.y - interval.x) / step), 1.0);
    float length = (interval.y - interval.x) / count;
    float tooth = random_next();
    MediaColumn column = media_column_none();
    for (int iteration = 0; iteration < MARCH_LIMIT && tooth < count; ++iteration) {
        float at = interval.x + tooth * length;
        float empty = media_column_add(column, spans, origin + at * direction, direction, at, length);
        tooth += 1.0 + floor(max(empty, 0.0) / length);
    }
    if (tooth < count) march_was_cut = true;
    return media_column_extinction(column);
}
