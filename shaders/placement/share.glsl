// A point of a stretch in which light is gathered, and its weight.
struct Placed { float at, weight; };

// Places points at even steps of a transmittance that falls by `optical_depth` over [0, 1]; in thin stretches evenly.
Placed placement_share(float optical_depth, float share)
{
    const float THIN = 0.1;
    if (optical_depth < THIN) return Placed(share, 1.0);
    float lost = 1.0 - exp(-optical_depth);
    float transmittance = 1.0 - share * lost;
    return Placed(-log(transmittance) / optical_depth, lost / (transmittance * optical_depth));
}
