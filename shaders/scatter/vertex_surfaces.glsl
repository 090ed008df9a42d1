// Where a path is scattered: by media, or by a diffuse surface.
struct WalkVertex {
    MediaField field;
    uint left;       // the shapes on whose boundary it lies, a bit each; 0: it is in media
    vec3 normal;     // a surface's, towards where the path came from
    Spectrum albedo;
};

// The first surface that a flight meets.
struct WalkWall {
    float at;    // distance; FAR_AWAY: none
    float limit; // what is beyond lies behind the surface
    uint after, shapes; // as of SurfaceHit
};

WalkVertex walk_vertex(MediaField field)
{
    return WalkVertex(field, 0u, vec3(0.0), spectrum(0.0));
}

// All objects are opaque: a flight begins outside of them.
WalkWall walk_wall(vec3 origin, vec3 direction, uint left)
{
    ShapeSpans shapes = shape_spans(origin, direction);
    SurfaceHit hit = surface_visible(shapes, 0.0, 0u, surface_left(left, origin, direction));
    float limit = hit.at < FAR_AWAY ? shape_spans_limit(shapes, hit.at, 1.0) : FAR_AWAY;
    return WalkWall(hit.at, limit, hit.after, hit.shapes);
}

bool walk_meet_wall(WalkWall wall, vec3 point, vec3 direction, inout WalkVertex met)
{
    int shape = findMSB(wall.shapes);
    vec3 normal = shape_normal(shape, point);
    if (dot(direction, normal) > 0.0) normal = -normal;
    met.left = wall.shapes;
    met.normal = normal;
    met.albedo = surface_albedo(surface_region(wall.after), point, shape);
    return true;
}

// The direction of light that a Lambertian surface scatters: its density is in proportion to the cosine.
vec3 walk_scatter_wall(vec3 normal)
{
    return scatter_turn(normal, 1.0 - sqrt(1.0 - walk_random()), walk_random());
}
