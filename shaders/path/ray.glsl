// A ray from the camera, or one that a surface reflected or refracted.
struct PathRay {
    vec3 origin, direction; // a unit vector
    Spectrum throughput;    // the share of its light that reaches the pixel
    float travelled;        // m, from the camera to `origin`
    int depth;              // reflections and refractions so far
    uint inside;            // the objects that contain it, a bit each
    uint left;              // the shapes on whose boundary `origin` lies, a bit each
    bool is_direct;         // it was never reflected
};
