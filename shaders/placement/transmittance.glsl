// Points along a homogeneous stretch at even steps of its transmittance.
struct PlacementTransmittance { float sigma_t, length; };

// At a share in [0, 1]; the weight is a length, the transmittance not yet in it. Thin stretches are shared out evenly.
Placed placement_transmittance_at(PlacementTransmittance way, float share)
{
    const float THIN = 0.1;
    float optical_depth = way.sigma_t * way.length;
    if (optical_depth < THIN) return Placed(share * way.length, way.length);
    float lost = 1.0 - exp(-optical_depth);
    float left = 1.0 - share * lost;
    return Placed(-log(left) / way.sigma_t, lost / (left * way.sigma_t));
}
