// Space rotated, folded along three diagonal mirrors and shifted, several times over; density rises inwards from a ball
// in the folded space. `rotation` is about x, then about y.
struct DensityFoldFractal { int iterations; mat3 rotation; float offset, radius, exponent, scale; };

// Signed distance to where density starts. Each step moves points rigidly or mirrors them, so it is 1-Lipschitz. Where
// x + y < 0 the first mirror takes x + y off both, which makes them (-y, -x); the others likewise, their sums taken in
// advance. A step's shift is part of the next one's rotation: operations wait for those before them, and like this
// least.
float density_fold_fractal_distance(DensityFoldFractal density, vec3 p)
{
    vec3 shift = density.rotation * vec3(density.offset);
    p += density.offset;
    for (int i = 0; i < density.iterations; ++i) {
        p = (density.rotation[1] * p.y - shift) + (density.rotation[0] * p.x + density.rotation[2] * p.z);
        vec3 sums = p + p.yzx;
        float xy = min(sums.x, 0.0);
        float yz = min(sums.y - xy, 0.0);
        float zx = min((sums.z - xy) - yz, 0.0);
        p = vec3((p.x - xy) - zx, (p.y - xy) - yz, (p.z - yz) - zx);
    }
    p -= density.offset;
    return length(p) - density.radius;
}

float density_fold_fractal_at(DensityFoldFractal density, float distance)
{
    return distance < 0.0 ? density.scale * pow(-distance, density.exponent) : 0.0;
}
