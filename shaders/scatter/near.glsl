// Light of a lamp in media or next to them. Its 1 / r^2 has an infinite variance where paths come near it by chance, so
// a part of the light that is scattered near it is left to vertices of their own, which are drawn together with the
// direction to them: Georgiev, Krivanek, Hachisuka, Nowrouzezahrai and Jarosz, ACM Transactions on Graphics 32(6),
// 2013.

// The reach around a lamp in a medium: some mean free paths of a majorant there, and a fraction of the medium's extent.
float walk_near_reach(float extent, float rate)
{
    return min(extent, 8.0 / max(rate, 1e-30));
}

// The part of what is scattered at `square`, the distance to the lamp squared, that belongs to these vertices: all of
// it at the lamp, nothing beyond its reach, and smooth between.
float walk_near_part(float square, float reach)
{
    float far = clamp(square / (reach * reach), 0.0, 1.0);
    return (1.0 - far) * (1.0 - far);
}

// A drawn vertex, and the inverse of its density.
struct WalkNear {
    vec3 direction;
    float distance, weight;
    int lamp; // near which it is
};

// On a ray, evenly in the angle that the lamp sees: Kulla and Fajardo, Computer Graphics Forum 31(4), 2012. `toward`
// leads from its origin to the lamp; the weight is per metre.
WalkNear walk_near_on(vec3 toward, vec3 direction, vec2 interval, float reach)
{
    float along = dot(toward, direction);
    vec3 off = toward - along * direction;
    float beside = max(length(off), 1e-6); // a lamp on the ray counts as a micrometre beside it
    float half_way = sqrt(max(reach * reach - beside * beside, 0.0));
    vec2 ends = vec2(max(interval.x, along - half_way), min(interval.y, along + half_way)) - along;
    if (ends.x >= ends.y) return WalkNear(direction, 0.0, 0.0, 0);
    float first = atan(ends.x, beside);
    float angle = atan(ends.y, beside) - first;
    float place = beside * tan(first + walk_random() * angle);
    return WalkNear(direction, along + clamp(place, ends.x, ends.y), angle * (beside * beside + place * place) / beside,
                    0);
}

// On the way from the lamp along `way`, evenly in the angle that the vertex before sees. `inverse` is that of the
// density of `way`; the weight is per metre and steradian as seen from the vertex before.
WalkNear walk_near_along(vec3 toward, vec3 way, float inverse, float reach)
{
    float along = -dot(toward, way);
    float beside = max(length(cross(toward, way)), 1e-6 * length(toward) + 1e-12);
    float first = atan(-along, beside);
    float angle = atan(reach - along, beside) - first;
    float away = clamp(along + beside * tan(first + walk_random() * angle), 0.0, reach);
    vec3 path = toward + away * way;
    float distance = max(length(path), 1e-12);
    return WalkNear(path / distance, distance, inverse * away * away * angle / beside, 0);
}

// In any direction from the lamp: evenly in its angle to the vertex before, up to `widest`. The whole density is in
// proportion to the inverse squares of both distances, so that what is left of them is finite.
WalkNear walk_near_about(vec3 toward, float reach, float widest)
{
    float angle = max(widest * walk_random(), 1e-6);
    float sine = sin(0.5 * angle);
    vec3 way = scatter_turn(-normalize(toward), 2.0 * sine * sine, walk_random());
    return walk_near_along(toward, way, 6.28318530717958648 * widest * sin(angle), reach);
}

const float WALK_NEAR_BESIDE = 1.1; // half-angles of a spot: a vertex that is farther off its axis is beside the cone

// In a spot's cone of half-angle `outer` about `axis`: evenly from beside it, else about the vertex before.
WalkNear walk_near_in_cone(vec3 toward, float reach, vec3 axis, float outer)
{
    float off = arc(length(cross(axis, toward)), -dot(axis, toward));
    if (off <= WALK_NEAR_BESIDE * outer) return walk_near_about(toward, reach, min(off + outer, 3.14159265358979324));
    float sine = sin(0.5 * outer);
    float less = 2.0 * sine * sine;
    vec3 way = scatter_turn(axis, less * walk_random(), walk_random());
    return walk_near_along(toward, way, 6.28318530717958648 * less, reach);
}
