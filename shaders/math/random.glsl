// Random numbers that follow from pixel, sample and frame alone. Generator and hash: O'Neill, PCG, Harvey Mudd College
// report HMC-CS-2014-0905, 2014, as Jarzynski and Olano, Journal of Computer Graphics Techniques 9(3), 2020, use it.
uint random_state = 0u;

uint random_hash(uint value)
{
    uint state = value * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// Begins the numbers of one sample of a pixel in one frame.
void random_start(uvec2 pixel, uint index, uint frame)
{
    random_state = random_hash(random_hash(random_hash(random_hash(frame) + index) + pixel.y) + pixel.x);
}

uint random_bits()
{
    uint bits = random_hash(random_state);
    random_state = random_state * 747796405u + 2891336453u;
    return bits;
}

// In [0, 1), a multiple of 2^-24.
float random_next()
{
    return float(random_bits() >> 8u) * (1.0 / 16777216.0);
}
