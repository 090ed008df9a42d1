// A ray on its way from the camera, or what a surface made of one.
struct PathRay {
    vec3 origin, direction; // a unit vector
    Spectrum throughput;    // the share of the light that comes along it which the pixel gets
    float travelled;        // m, from the camera to `origin`
    int depth;              // reflections and refractions on that way
    uint inside;            // the objects that contain it, a bit each
    uint left;              // the shapes on whose boundary `origin` lies, a bit each
    bool is_direct;         // it was never reflected
};
