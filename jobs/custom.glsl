// A shell around a gyroid, twisted about the y axis and drifting upwards; positive inside the shell, about metres outside.
const float CELLS = 9.0;     // waves of the gyroid, rad/m
const float THICKNESS = 0.28; // of the shell, in the gyroid's own values
const float TWIST = 0.8;     // rad/m

vec3 twist(vec3 p, float angle)
{
    float c = cos(angle), s = sin(angle);
    return vec3(c * p.x - s * p.z, p.y, s * p.x + c * p.z);
}

float gyroid(vec3 p)
{
    return dot(sin(p), cos(p.zxy));
}

float density(vec3 p, float t)
{
    vec3 q = CELLS * twist(p, TWIST * p.y + 0.25 * t) + vec3(0.0, -0.6 * t, 0.0);
    return (THICKNESS - abs(gyroid(q))) / CELLS;
}
