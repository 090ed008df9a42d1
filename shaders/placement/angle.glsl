// Points along a stretch by the angle seen from a point light, which takes its 1 / r^2 out of the sum: Kulla and Fajardo,
// Computer Graphics Forum 31, 2012. Where transmittance falls over all of the angle, the angle is shared out as it falls
// where it does so slowest, next to the light: exact for a far light, and a thick medium's points lie where there is light.
struct PlacementAngle {
    float height; // of the light over the ray
    float ahead;  // where the stretch begins, counted from the light's foot on the ray
    float angle;  // the whole stretch's
    float extent; // of the stretch
    float optical_depth; // that the angle is shared out by
};

// The angle is taken from the difference of its tangents: of a far light both ends' own angles are nearly the same. A light
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

// At a share in [0, 1]; the weight is that of the light's intensity, in 1/m, the transmittance not yet in it.
Placed placement_angle_at(PlacementAngle placement, float share)
{
    Placed placed = placement_share(placement.optical_depth, share);
    float s = sin(placed.at * placement.angle);
    float c = cos(placed.at * placement.angle);
    float at = s * (placement.height * placement.height + placement.ahead * placement.ahead) /
               max(placement.height * c - placement.ahead * s, 1e-30);
    return Placed(min(at, placement.extent), placed.weight * placement.angle / placement.height);
}
