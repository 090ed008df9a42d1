// Points along a stretch at even steps of the angle seen from a point light, which takes its 1 / r^2 out of the sum.
// Kulla and Fajardo, Computer Graphics Forum 31, 2012.
struct PlacementAngle {
    float height; // of the light over the ray
    float ahead;  // where the stretch begins, counted from the light's foot on the ray
    float angle;  // the whole stretch's
    float length;
};

// The angle is taken from the difference of its tangents: of a far light both ends' own angles are nearly the same. A light
// on the ray counts as a micrometre beside it.
PlacementAngle placement_angle(vec3 toward, vec3 direction, float length)
{
    float along = dot(toward, direction);
    vec3 off = toward - along * direction;
    float height = max(sqrt(dot(off, off)), 1e-6);
    return PlacementAngle(height, -along, atan(length * height, height * height - along * (length - along)), length);
}

// At a share in [0, 1] of the angle; the weight is that of the light's intensity, in 1/m.
Placed placement_angle_at(PlacementAngle way, float share)
{
    float s = sin(share * way.angle);
    float c = cos(share * way.angle);
    float at = s * (way.height * way.height + way.ahead * way.ahead) / max(way.height * c - way.ahead * s, 1e-30);
    return Placed(min(at, way.length), way.angle / way.height);
}
