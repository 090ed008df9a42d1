// A boundary counts where the regions on its two sides differ; others only change the set of objects.
struct SurfaceHit {
    float at;           // distance along the ray; FAR_AWAY for none
    uint before, after; // the objects that contain either side
    uint shapes;        // as SurfaceCrossing has them; the last one is that of the object that begins or ends
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
