// Planck's light in linear Rec. 709, of luminance 1 at 1500 K. `table` is a row over 1/kelvin from 0 to that of the
// coldest body which still glows: the colour divided by its luminance (rgb; a component is negative where the colour is
// outside of Rec. 709) and log2(luminance / kelvin). Both are nearly straight there, which keeps a row of 1024 within
// 1e-4.
const float BLACKBODY_COLDEST = 400.0;

vec3 emission_blackbody(sampler2D table, float kelvin)
{
    if (!(kelvin > BLACKBODY_COLDEST)) return vec3(0.0);
    int cells = textureSize(table, 0).x - 1;
    float at = float(cells) * (BLACKBODY_COLDEST / kelvin);
    int cell = min(int(at), cells - 1);
    vec4 low = texelFetch(table, ivec2(cell, 0), 0);
    vec4 high = texelFetch(table, ivec2(cell + 1, 0), 0);
    vec4 entry = mix(low, high, at - float(cell));
    return max(entry.rgb, 0.0) * (kelvin * exp2(entry.a));
}
