// Where a random path begins.
struct WalkRay {
    vec3 origin, direction; // a unit vector: where one looks, against the light's travel
    vec2 interval;          // distances between which media count
};
