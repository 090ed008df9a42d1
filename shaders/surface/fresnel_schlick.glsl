// Reflected share from `f0` at right angles to `f90` along the surface: Schlick, Computer Graphics Forum 13(3), 1994.
// The cosine is that on the side of the smaller ior, which makes both directions through a boundary alike: de Greve,
// Reflections and Refractions in Ray Tracing, 2006. eta = ior before / ior after.
struct FresnelSchlick { float f0, f90; };

float fresnel_schlick(FresnelSchlick fresnel, float cos_in, float eta)
{
    float after = snell_cos(cos_in, eta);
    if (after < 0.0) return 1.0;
    float missing = 1.0 - clamp(eta > 1.0 ? after : cos_in, 0.0, 1.0);
    float square = missing * missing;
    return clamp(mix(fresnel.f0, fresnel.f90, square * square * missing), 0.0, 1.0);
}
