// A sphere of even radiance outside, dark inside: intensity / (pi radius^2), with the intensity in W/sr seen from afar.
struct LightSphere { Spectrum intensity; vec3 position; float radius; };

// A random point of it: directions are even in the solid angle that it fills, and the irradiance is all of that angle
// times the radiance. Shirley, Wang and Zimmerman, ACM Transactions on Graphics 15, 1996. `share` is in [0, 1)^2.
LightSample light_sphere(LightSphere light, vec3 point, vec2 share)
{
    vec3 toward = light.position - point;
    float square = max(dot(toward, toward), 1e-30);
    float sine_square = min(light.radius * light.radius / square, 1.0);
    // 1 less the cosines, which are not differences of numbers near 1.
    float cap = sine_square / (1.0 + sqrt(1.0 - sine_square));
    float below = share.x * cap;
    float aside = below * (2.0 - below);
    vec3 axis = toward * inversesqrt(square);
    float far = sqrt(square) * (1.0 - below - sqrt(max(sine_square - aside, 0.0)));
    float lit = square > light.radius * light.radius ? 2.0 * cap / (light.radius * light.radius) : 0.0;
    return LightSample(scatter_turn(axis, below, share.y), far, light.intensity * lit);
}
