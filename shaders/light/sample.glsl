// A light's sample at a point, if nothing is between them.
struct LightSample {
    vec3 direction; // towards the light
    float distance;
    Spectrum irradiance;
};
