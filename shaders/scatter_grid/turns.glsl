// What walks from the nodes and particles from the lights share: how far a turn goes, and when faint light ends.
const int SCATTER_GRID_ITERATIONS = 40000; // of one turn: some drivers end loops after 65,535

// What is fainter than SCATTER_GRID_FAINT, which the scene decides, ends at random, and is weighted where it goes on,
// which keeps the mean.
Spectrum scatter_walk_thin(Spectrum weight)
{
    float most = spectrum_max(weight);
    if (most >= SCATTER_GRID_FAINT) return weight;
    return walk_random() * SCATTER_GRID_FAINT < most ? weight * (SCATTER_GRID_FAINT / most) : spectrum(0.0);
}
