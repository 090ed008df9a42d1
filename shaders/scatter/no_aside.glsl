// Vertices that send no second paths, in place of aside.glsl.

const bool WALK_SENDS = false;

bool walk_sends()
{
    return false;
}

float walk_aside_goes_on()
{
    return 0.0;
}

float walk_aside_density(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, vec3 outgoing)
{
    return 0.0;
}

Spectrum walk_aside(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, out vec3 outgoing)
{
    outgoing = incoming;
    return spectrum(0.0);
}
