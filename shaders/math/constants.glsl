// Numbers that several modules use.
const float INV_4PI = 0.0795774715459476679;
const float FAR_AWAY = 1e30; // metres: beyond anything, yet it can still be added and doubled
