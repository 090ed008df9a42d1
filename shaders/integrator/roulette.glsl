// Russian roulette: a ray with little throughput left ends by lot, and one that goes on stands for those that ended, so
// that the mean stays what it is. Arvo and Kirk, Particle Transport and Image Synthesis, SIGGRAPH 1990.
struct IntegratorRoulette { float below, survive; };

// What the throughput becomes: 0 for a ray that ends. Nobody goes on with more than 1, whatever the odds asked for.
Spectrum integrator_roulette(IntegratorRoulette roulette, Spectrum throughput)
{
    float most = spectrum_max(throughput);
    if (most >= roulette.below) return throughput;
    float odds = max(roulette.survive, most);
    return random_next() < odds ? throughput / odds : spectrum(0.0);
}
