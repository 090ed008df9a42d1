// Homogeneous media, from edge to edge of their spans: each stretch between is gathered as one.
struct IntegratorStretches { int count; }; // upper bound on the number of stretches

void integrator_stretches(IntegratorStretches method, vec3 origin, vec3 direction, vec2 interval, MediaSpans spans,
                          inout Gathered gathered)
{
    float at = interval.x;
    for (int i = 0; i < method.count && at < interval.y && !gathered_is_over(gathered); ++i) {
        float edge = media_next_edge(spans, at, interval.y);
        vec3 begin = origin + at * direction;
        // Density is the same everywhere in the stretch; only the spans that it is in count.
        MediaField field = media_field(spans, begin, direction, at + 0.5 * (edge - at));
        gather(gathered, field, begin, direction, at, edge - at);
        at = edge;
    }
}
