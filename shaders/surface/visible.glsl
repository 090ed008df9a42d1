// A boundary counts where the regions on its two sides differ; others only change the set of objects.
struct SurfaceHit {
    float at;           // distance along the ray; FAR_AWAY for none
    uint before, after; // the objects that contain either side
    uint shapes;        // as in SurfaceCrossing; the last one is that of the object that begins or ends
};

SurfaceHit surface_visible(ShapeSpans spans, float from, uint inside, uint left)
{
    SurfaceHit hit = SurfaceHit(from, inside, inside, left);
    for (int i = 0; i < MARCH_LIMIT; ++i) {
        SurfaceCrossing next = surface_next(spans, hit.at, hit.after, left);
        hit = SurfaceHit(next.at, hit.after, next.inside, next.shapes);
        if (next.at >= FAR_AWAY || surface_region(hit.before) != surface_region(hit.after)) return hit;
    }
    march_was_cut = true;
    return hit;
}

// Returns those of the shapes whose boundaries meet at a ray's origin that the ray does not lead into: in a corner of
// two, a ray that one has sent may lead right into the other.
uint surface_left(uint shapes, vec3 origin, vec3 direction)
{
    const float ALONG = -1e-6; // parallel to a boundary, within rounding
    uint left = shapes;
    for (uint rest = shapes; (rest & (rest - 1u)) != 0u; rest &= rest - 1u) {
        int shape = findLSB(rest);
        if (dot(direction, shape_normal(shape, origin)) < ALONG) left ^= 1u << uint(shape);
    }
    return left;
}
