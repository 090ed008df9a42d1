// Space rotated, folded along three diagonal mirrors and shifted, several times over; density rises inwards from a ball in
// the folded space. `rotation` turns about x, then about y.
struct DensityFoldFractal { int iterations; mat3 rotation; float offset, radius, exponent, scale; };

// Signed distance to where density starts: each step moves points rigidly or mirrors them, so it is 1-Lipschitz.
float density_fold_fractal_distance(DensityFoldFractal density, vec3 p)
{
    for (int i = 0; i < density.iterations; ++i) {
        p = density.rotation * p;
        // Where x + y < 0 this is (x, y) = (-y, -x), and so on.
        float fold = min(p.x + p.y, 0.0);
        p.xy -= fold;
        fold = min(p.y + p.z, 0.0);
        p.yz -= fold;
        fold = min(p.z + p.x, 0.0);
        p.zx -= fold;
        p -= density.offset;
    }
    return length(p) - density.radius;
}

float density_fold_fractal_at(DensityFoldFractal density, float distance)
{
    return distance < 0.0 ? density.scale * pow(-distance, density.exponent) : 0.0;
}
