// A boundary without reflection, except total reflection.
float fresnel_none(float cos_in, float eta)
{
    return snell_cos(cos_in, eta) < 0.0 ? 1.0 : 0.0;
}
