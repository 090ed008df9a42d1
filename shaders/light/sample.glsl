// What reaches a point from a light if nothing is between.
struct LightSample {
    vec3 direction; // towards the light
    float distance;
    Spectrum irradiance;
};
