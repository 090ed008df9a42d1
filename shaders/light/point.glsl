// A point with radiant intensity in W/sr: irradiance falls with the square of the distance.
struct LightPoint { Spectrum intensity; vec3 position; };

// At the light itself there is no direction, and the irradiance is that of a micrometre away.
LightSample light_point(LightPoint light, vec3 point)
{
    vec3 toward = light.position - point;
    float square = max(dot(toward, toward), 1e-12);
    float inverse = inversesqrt(square);
    return LightSample(toward * inverse, square * inverse, light.intensity / square);
}
