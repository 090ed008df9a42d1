// The grid of a sun, or of a point light outside of all media: a box whose far end is wider than its near one, as light
// spreads. Coordinates are in [0, 1]: x and y across the light, z along it. Positions are relative to a centre among
// the media, so that a light that is far away does not cost them digits.
struct LightGridBeam {
    vec3 center;
    mat3 from_unit; // metres; across, up and along the light, of the whole grid in the plane of the centre
    mat3 to_unit;
    vec3 origin; // coordinates of the centre
    float taper; // the share of its width there by which the grid widens over its length; 0 for a sun
};

vec3 light_grid_beam_at(LightGridBeam grid, vec3 p)
{
    vec3 at = grid.to_unit * (p - grid.center);
    return vec3(at.xy / (1.0 + grid.taper * at.z), at.z) + grid.origin;
}

LightGridRay light_grid_beam_ray(LightGridBeam grid, vec2 column)
{
    vec2 aside = column - grid.origin.xy;
    float begin = -grid.origin.z;
    vec3 axis = grid.from_unit * vec3(aside * grid.taper, 1.0);
    float length = length(axis);
    vec3 start = grid.center + grid.from_unit * vec3(aside * (1.0 + grid.taper * begin), begin);
    return LightGridRay(start, axis / length, length);
}
