// Random numbers of one path: 64 bits of state, so that the paths of a picture do not share any. The generator and the
// hash are those of math/random.glsl; the second half of the state chooses among 2^32 sequences, another for each path
// of a pixel. Plans and pictures have streams of their own.
uint walk_random_state = 0u;
uint walk_random_key = 0u;

void walk_random_start(uvec2 pixel, uint path, uint index, uint frame)
{
    uint place = pixel.x | (pixel.y << 16u);
    uint moment = random_hash(random_hash(index + 0x85ebca6bu * uint(random_stream)) + frame);
    walk_random_key = random_hash(random_hash(random_hash(place) + moment) + path);
    walk_random_state = random_hash(random_hash(random_hash(place ^ 0x9e3779b9u) + path) + moment);
}

// Goes on with a path's numbers, where walk_random_start has begun them: its state was kept.
void walk_random_resume(uint state)
{
    walk_random_state = state;
}

// In [0, 1), a multiple of 2^-24.
float walk_random()
{
    uint bits = random_hash(walk_random_state ^ walk_random_key);
    walk_random_state = walk_random_state * 747796405u + 2891336453u;
    return float(bits >> 8u) * (1.0 / 16777216.0);
}
