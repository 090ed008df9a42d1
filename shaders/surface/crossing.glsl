// Where a ray crosses the boundaries of objects. Which objects contain it is known from what it has crossed, a bit for each
// object, not from where a rounded point seems to lie. Shapes are convex: who has left one never meets it again.

// Boundaries that coincide are told from others by rays that are no flatter than this, as the cosine to the normal.
const float SURFACE_FLATTEST = 0.01;

// The nearest boundary, or several that coincide.
struct SurfaceCrossing {
    float at;    // distance along the ray; FAR_AWAY for none
    uint inside; // the objects that contain what is beyond
    uint shapes; // the shapes whose boundaries they are, a bit each
};

// Where objects overlap the last one is there alone: its number, counted from 1; 0 for air.
int surface_region(uint inside)
{
    return findMSB(inside) + 1;
}

// Where a ray that is outside of a shape enters it. One that is found in it enters at once, but not what ends before `limit`:
// that lies at `from`, but for rounding. From far away a shape may be shorter than a distance's last digit: it is missed, or it
// would be entered again and again.
float surface_entry(vec2 span, float from, float limit)
{
    if (span.x >= from) return span.x < span.y ? span.x : FAR_AWAY;
    return span.y > limit ? from : FAR_AWAY;
}

// The objects that a ray from within a region begins in. Those that the region's own object is there instead of are entered at
// once, which nobody sees.
uint surface_set(int region)
{
    return (1u << uint(region)) >> 1u;
}
