// A transfer function is linear between its points. Points are applied in ascending order; each replaces the result as
// soon as the value passes it. Without a table nothing is rounded to one.

// Returns a value's share of the distance from one point to the next, in [0, 1].
float transfer_share(float value, float start, float inverse_width)
{
    return clamp((value - start) * inverse_width, 0.0, 1.0);
}

// Mixes exactly at both ends, unlike before + share * (after - before): zeros stay 0.
float transfer_mix(float before, float after, float share)
{
    return before * (1.0 - share) + after * share;
}

vec3 transfer_mix(vec3 before, vec3 after, float share)
{
    return before * (1.0 - share) + after * share;
}

// Returns the extinction per metre for an opacity in [0, 1) over `unit_distance`: -ln(1 - opacity) / unit_distance.
// Where 1 - opacity would lose digits it is a series, -ln(1 - a) = 2 artanh(a / (2 - a)).
float transfer_extinction(float opacity, float unit_distance)
{
    const float SERIES_LIMIT = 0.5;
    float z = opacity / (2.0 - opacity);
    float square = z * z;
    float series = 2.0 * z * (1.0 + square * (1.0 / 3.0 + square * (1.0 / 5.0 + square * (1.0 / 7.0
                   + square * (1.0 / 9.0 + square * (1.0 / 11.0 + square * (1.0 / 13.0)))))));
    return (opacity < SERIES_LIMIT ? series : -log(1.0 - opacity)) / unit_distance;
}
