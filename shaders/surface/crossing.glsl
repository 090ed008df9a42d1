// Crossings of a ray with the boundaries of objects. The set of objects that contain the ray, a bit each, follows from
// what it has crossed, not from a rounded point. Shapes are convex: a ray that has left one never meets it again.

// Coinciding boundaries are recognized on rays no flatter than this, as the cosine to the normal.
const float SURFACE_FLATTEST = 0.01;

// The nearest boundary, or several that coincide.
struct SurfaceCrossing {
    float at;    // distance along the ray; FAR_AWAY for none
    uint inside; // the objects that contain the points beyond
    uint shapes; // the shapes that these boundaries belong to, a bit each
};

// Returns the region: of overlapping objects the last one's number, counted from 1; 0 for air.
int surface_region(uint inside)
{
    return findMSB(inside) + 1;
}

// Returns where a ray outside of a shape enters it. A ray that is found inside enters at once, unless the shape ends
// before `limit`, which equals `from` within rounding. From far away a shape may be shorter than a distance's last
// digit: then it is missed, or it would be entered again and again.
float surface_entry(vec2 span, float from, float limit)
{
    if (span.x >= from) return span.x < span.y ? span.x : FAR_AWAY;
    return span.y > limit ? from : FAR_AWAY;
}

// Returns the objects that contain the origin of a ray from within a region. Objects that the region's own object
// replaces are entered at once, which is invisible.
uint surface_set(int region)
{
    return (1u << uint(region)) >> 1u;
}
