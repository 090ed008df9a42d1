// Points along a homogeneous stretch at even steps of its transmittance.
struct PlacementTransmittance { float optical_depth, extent; };

// Places a point at a share in [0, 1]. The weight is a length, without the transmittance.
Placed placement_transmittance_at(PlacementTransmittance placement, float share)
{
    Placed placed = placement_share(placement.optical_depth, share);
    return Placed(placed.at * placement.extent, placed.weight * placement.extent);
}
