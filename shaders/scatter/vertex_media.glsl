// Where a path is scattered: by media alone.
struct WalkVertex {
    MediaField field;
    uint left; // 0: it lies on no surface
};

// What a flight meets beyond the media: nothing.
struct WalkWall { float at, limit; };

WalkVertex walk_vertex(MediaField field)
{
    return WalkVertex(field, 0u);
}

WalkWall walk_wall(vec3 origin, vec3 direction, uint left)
{
    return WalkWall(FAR_AWAY, FAR_AWAY);
}

bool walk_meet_wall(WalkWall wall, vec3 point, vec3 direction, inout WalkVertex met)
{
    return false;
}
