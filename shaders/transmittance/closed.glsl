// Column towards a light through homogeneous media: the length of the shadow ray in each, no march.
MediaColumn transmittance_closed(MediaSpans spans, float distance)
{
    return media_column_begin(spans, distance);
}
