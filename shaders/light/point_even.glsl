// A point that lights every point with the same irradiance, whatever the distance.
struct LightPointEven { Spectrum irradiance; vec3 position; };

LightSample light_point_even(LightPointEven light, vec3 point)
{
    vec3 toward = light.position - point;
    float square = max(dot(toward, toward), 1e-12);
    float inverse = inversesqrt(square);
    return LightSample(toward * inverse, square * inverse, light.irradiance);
}
