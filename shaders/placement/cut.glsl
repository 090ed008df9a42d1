// Cuts a stretch in which colours fade over very different lengths, so that each colour has points where its light is.

// Returns the ends of the pieces, the last one at `extent`; colours of about equal optical depth share a piece.
vec3 placement_cut(vec3 sigma_t, float extent)
{
    const float ALIKE = 4.0;
    const float FADED = 10.0; // optical depth: beyond it, errors of this colour do not matter
    float least = min(min(sigma_t.r, sigma_t.g), sigma_t.b);
    float most = max(max(sigma_t.r, sigma_t.g), sigma_t.b);
    float middle = max(min(sigma_t.r, sigma_t.g), min(max(sigma_t.r, sigma_t.g), sigma_t.b));
    return vec3(most > ALIKE * least ? min(FADED / most, extent) : extent,
                middle > ALIKE * least ? min(FADED / middle, extent) : extent, extent);
}
