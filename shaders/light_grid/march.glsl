// Columns from a light to all nodes of a ray in one march, by the midpoint rule: segments end at nodes and where a
// medium's span does, and space that the media's bounds show to be empty is stepped over.

void light_grid_march(LightGridRay ray, ivec2 at_grid, int cells)
{
    MediaSpans spans = media_spans(ray.start, ray.direction);
    vec2 interval = media_column_interval(spans);
    MediaColumn column = media_column_begin(spans, 0.0);
    float cell = ray.length / float(cells);
    float end = min(interval.y, ray.length);
    float at = max(interval.x, 0.0);
    int node = 0;
    for (int iteration = 0; iteration < MARCH_LIMIT && at < end; ++iteration) {
        for (; node <= cells && float(node) * cell <= at; ++node)
            light_grid_store(ivec3(at_grid, node), column);
        float until = min(media_column_next_edge(spans, at, end), float(node) * cell);
        float half_length = 0.5 * (until - at);
        float middle = at + half_length;
        float empty = media_column_add(column, spans, ray.start + middle * ray.direction, ray.direction, middle,
                                       2.0 * half_length);
        // One sum, not two: the last half may be too small to change `at`.
        at += half_length + max(half_length, empty);
    }
    if (at < end) light_grid_cut(column);
    for (; node <= cells; ++node)
        light_grid_store(ivec3(at_grid, node), column);
}
