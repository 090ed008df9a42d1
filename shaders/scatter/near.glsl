// Light of a lamp in media or next to them. Its 1 / r^2 has an infinite variance where paths come near it by chance, so
// a part of the light that is scattered near it is left to vertices of their own, which are drawn together with the
// direction to them: Georgiev, Krivanek, Hachisuka, Nowrouzezahrai and Jarosz, ACM Transactions on Graphics 32(6),
// 2013.

// The reach around a lamp in a medium: some mean free paths of a majorant there, and a fraction of the medium's extent.
float walk_near_reach(float extent, float rate)
{
    return min(0.25 * extent, 4.0 / max(rate, 1e-30));
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

// In any direction: evenly in its angle to the lamp, as far as the reach has rays, and then as above. The density is in
// proportion to 1 / r^2 and to the angle's sine, so that what is left of both is finite. The weight is per metre and
// steradian.
WalkNear walk_near_about(vec3 toward, float reach)
{
    float apart = max(length(toward), 1e-6);
    float widest = apart > reach ? asin(reach / apart) : 3.14159265358979324;
    float angle = max(widest * walk_random(), 1e-6);
    float sine = sin(0.5 * angle);
    vec3 direction = scatter_turn(toward / apart, 2.0 * sine * sine, walk_random());
    WalkNear near = walk_near_on(toward, direction, vec2(0.0, FAR_AWAY), reach);
    near.weight *= 6.28318530717958648 * widest * sin(angle);
    return near;
}
