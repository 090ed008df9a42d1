// Cuts a stretch in which colours fade at very different lengths, so that each has points where its light is.

// Where the pieces end, the last one at `extent`; colours that are about as thick as one another make one piece.
vec3 placement_cut(vec3 sigma_t, float extent)
{
    const float ALIKE = 4.0;
    const float FADED = 10.0; // optical depth: what points meant for others do with the rest does not matter
    float least = min(min(sigma_t.r, sigma_t.g), sigma_t.b);
    float most = max(max(sigma_t.r, sigma_t.g), sigma_t.b);
    float middle = max(min(sigma_t.r, sigma_t.g), min(max(sigma_t.r, sigma_t.g), sigma_t.b));
    return vec3(most > ALIKE * least ? min(FADED / most, extent) : extent,
                middle > ALIKE * least ? min(FADED / middle, extent) : extent, extent);
}
