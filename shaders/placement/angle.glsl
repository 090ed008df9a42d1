// Points along a stretch by the angle at which a point light sees it, which takes 1 / r^2 out of the sum: Kulla and
// Fajardo, Computer Graphics Forum 31, 2012. Where transmittance falls over the whole angle, points follow that fall as
// it is where it is slowest, next to the light. This is exact for a far light, and in a thick medium points lie where
// there is light.
struct PlacementAngle {
    float height; // of the light over the ray
    float ahead;  // where the stretch begins, counted from the foot of the perpendicular from the light
    float angle;  // of the whole stretch
    float extent; // of the stretch
    float optical_depth; // over the angle
};

// The angle follows from the difference of its tangents: of a far light both ends' own angles are nearly equal. A light
// on the ray counts as a micrometre beside it.
PlacementAngle placement_angle(vec3 toward, vec3 direction, float length, float sigma_t)
{
    float along = dot(toward, direction);
    vec3 off = toward - along * direction;
    float height = max(sqrt(dot(off, off)), 1e-6);
    float angle = arc(length * height, height * height - along * (length - along));
    float nearest = clamp(0.0, -along, length - along);
    float slowest = sigma_t * (height + nearest * (nearest / height)); // optical depth per angle
    return PlacementAngle(height, -along, angle, length, min(slowest * angle, sigma_t * length));
}

// Places a point at a share in [0, 1]. The weight is for the light's intensity, in 1/m, without the transmittance.
Placed placement_angle_at(PlacementAngle placement, float share)
{
    Placed placed = placement_share(placement.optical_depth, share);
    float s = sin(placed.at * placement.angle);
    float c = cos(placed.at * placement.angle);
    float at = s * (placement.height * placement.height + placement.ahead * placement.ahead) /
               max(placement.height * c - placement.ahead * s, 1e-30);
    return Placed(min(at, placement.extent), placed.weight * placement.angle / placement.height);
}
