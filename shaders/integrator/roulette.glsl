// Russian roulette: a ray of low throughput ends at random, and one that goes on is weighted for those that ended,
// which keeps the mean. Arvo and Kirk, Particle Transport and Image Synthesis, SIGGRAPH 1990.
struct IntegratorRoulette { float below, survive; };

// Returns the new throughput: 0 for a ray that ends. No ray goes on with more than 1, whatever the odds asked for.
Spectrum integrator_roulette(IntegratorRoulette roulette, Spectrum throughput)
{
    float most = spectrum_max(throughput);
    if (most >= roulette.below) return throughput;
    float odds = max(roulette.survive, most);
    return random_next() < odds ? throughput / odds : spectrum(0.0);
}
