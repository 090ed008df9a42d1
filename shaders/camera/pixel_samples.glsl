// Points of a pixel's samples: columns x rows strata, one random point in each. The order of strata is random for each
// pixel, so that position and time (which follows the index) are independent.
struct PixelSamples { uint columns, rows; };

// One of the permutations of 0..count - 1 (2 <= count <= 1024), chosen by `seed`: invertible steps permute the numbers
// up to the next power of two, and are repeated until the result is below `count`. The final rotation makes all results
// equally likely for each index.
uint pixel_samples_permute(uint index, uint count, uint seed)
{
    uint top = uint(findMSB(count - 1u));
    uint mask = (2u << top) - 1u;
    uint shift = top / 2u + 1u;
    for (int iteration = 0; iteration < 1024; ++iteration) {
        uint key = seed;
        for (int round = 0; round < 3; ++round) {
            key = random_hash(key);
            index = (index * (key | 1u) + (key >> 16u)) & mask;
            index ^= index >> shift;
        }
        if (index < count) break;
    }
    return (index + random_hash(seed ^ 0x5bd1e995u) % count) % count;
}

// Returns the point in pixels from the image's top left. It is computed in whole numbers, so that all drivers agree.
// The sample's further random numbers follow those of its point. The one after the last is the pixel's centre.
vec2 pixel_samples_point(PixelSamples samples, uvec2 pixel, uint index, uint frame)
{
    const uint ALL_SAMPLES = 0xffffffffu;
    if (index >= samples.columns * samples.rows) return vec2(pixel) + 0.5;
    random_start(pixel, ALL_SAMPLES, frame);
    uint stratum = pixel_samples_permute(index, samples.columns * samples.rows, random_bits());
    random_start(pixel, index, frame);
    uint across = (((stratum % samples.columns) << 20u) + (random_bits() >> 12u)) / samples.columns;
    uint down = (((stratum / samples.columns) << 20u) + (random_bits() >> 12u)) / samples.rows;
    return vec2(pixel) + vec2(across, down) * (1.0 / 1048576.0);
}
