// One number stands for all wavelengths: nothing in the scene has a colour.
#define Spectrum float

Spectrum spectrum(float value) { return value; }
float spectrum_mean(Spectrum value) { return value; }
float spectrum_min(Spectrum value) { return value; }
float spectrum_max(Spectrum value) { return value; }
vec3 spectrum_rgb(Spectrum value) { return vec3(value); }
Spectrum spectrum_select(Spectrum below, Spectrum above, Spectrum value, float limit)
{
    return value < limit ? below : above;
}
