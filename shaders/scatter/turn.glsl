// Directions of travel behind a scattering, from their angle.

// Returns the unit vector that makes an angle with the unit vector `axis`, by 1 - cos of the angle, and is turned about
// it by `turn` in [0, 1]. The frame is that of Duff, Burgess, Christensen, Hery, Kensler, Liani and Villemin,
// Journal of Computer Graphics Techniques 6(1), 2017.
vec3 scatter_turn(vec3 axis, float less, float turn)
{
    float side = axis.z < 0.0 ? -1.0 : 1.0;
    float a = -1.0 / (side + axis.z);
    float b = axis.x * axis.y * a;
    vec3 across = vec3(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x);
    vec3 up = vec3(b, side + axis.y * axis.y * a, -axis.y);
    float sine = sqrt(max(less * (2.0 - less), 0.0));
    float angle = turn * 6.28318530717958648;
    return normalize((1.0 - less) * axis + sine * (cos(angle) * across + sin(angle) * up));
}
