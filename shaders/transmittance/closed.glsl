// Column towards a light through media of even density: the length of the way in each, no march.
MediaColumn transmittance_closed(vec3 point, vec3 direction, float distance)
{
    return media_column_begin(media_spans(point, direction), distance);
}
