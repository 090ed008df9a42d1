// Numbers that several modules use.
const float INV_4PI = 0.0795774715459476679;
const float FAR_AWAY = 1e18; // metres: beyond everything, yet its square is finite
