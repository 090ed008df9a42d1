// Linear Rec. 709 red, green and blue, each followed on its own.
#define Spectrum vec3

Spectrum spectrum(float value) { return vec3(value); }
float spectrum_mean(Spectrum value) { return (value.r + value.g + value.b) * (1.0 / 3.0); }
float spectrum_min(Spectrum value) { return min(min(value.r, value.g), value.b); }
float spectrum_max(Spectrum value) { return max(max(value.r, value.g), value.b); }
vec3 spectrum_rgb(Spectrum value) { return value; }
Spectrum spectrum_select(Spectrum below, Spectrum above, Spectrum value, float limit)
{
    return mix(above, below, lessThan(value, vec3(limit)));
}
