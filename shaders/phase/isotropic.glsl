// Equal in all directions, normalized over the sphere.
float phase_isotropic()
{
    return INV_4PI;
}
