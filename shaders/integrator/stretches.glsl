// Media of even density, from edge to edge of their spans: each stretch between is one segment, integrated exactly.
struct IntegratorStretches { int count; }; // the most stretches there can be

void integrator_stretches(IntegratorStretches method, vec3 origin, vec3 direction, vec2 interval, MediaSpans spans,
                          inout Gathered gathered)
{
    float at = interval.x;
    for (int i = 0; i < method.count && at < interval.y; ++i) {
        float edge = media_next_edge(spans, at, interval.y);
        float middle = at + 0.5 * (edge - at);
        vec3 point = origin + middle * direction;
        gather(gathered, media_field(spans, point, direction, middle), point, direction, at, edge - at);
        at = edge;
    }
}
