// A Riemann sum of samples at near + k step, k = 1..count: each adds its source times the transmittance of those
// before, then attenuates. `count` is computed in double precision, since drivers round half a step differently.
struct IntegratorRiemann { float near, step; int count; };

void integrator_riemann(IntegratorRiemann method, vec3 origin, vec3 direction, MediaSpans spans,
                        inout Gathered gathered)
{
    int k = int(march_resume(vec2(1.0, 0.0), float(method.count) + 0.5, gathered).x);
    for (int iteration = 0; iteration < MARCH_ITERATIONS && k <= method.count; ++iteration) {
        float at = 0.0;
        MediaField field;
        // Samples before the distance at which there may be density again have none either.
        for (; iteration < MARCH_ITERATIONS && k <= method.count; ++iteration) {
            at = method.near + float(k) * method.step;
            field = media_field(spans, origin + at * direction, direction, at);
            if (field.distance < 0.0) break;
            k += 1 + int(min(field.distance / method.step, float(method.count)));
        }
        march_keep(vec2(float(k), 0.0), k > method.count, gathered);
        if (k > method.count) break;
        gather(gathered, field, origin + at * direction, direction, at - method.step, method.step);
        ++k;
        if (k > method.count || gathered_is_over(gathered)) {
            march_keep(vec2(float(k), 0.0), true, gathered);
            break;
        }
    }
    if (k <= method.count && !gathered_is_over(gathered)) march_was_cut = true;
}
