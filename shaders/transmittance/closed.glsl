// Column towards a light through media of even density: the length of the way in each, no march.
MediaColumn transmittance_closed(MediaSpans spans, float distance)
{
    return media_column_begin(spans, distance);
}
