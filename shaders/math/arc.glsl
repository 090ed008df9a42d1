// The angle of a point, in (-pi, pi].

// Some drivers' arc tangent has but five digits; one step of Newton's method gives all.
float arc(float y, float x)
{
    float angle = atan(y, x);
    float s = sin(angle);
    float c = cos(angle);
    return angle + (y * c - x * s) / (x * c + y * s);
}
