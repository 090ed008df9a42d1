// Fills the grid of scattered light: from each node walks go out against the light, and gather what they meet. The
// mean over a node's walks has no bias, whatever the grid. A walk that ends makes room for the node's next one, so that
// one loop follows them all. Free flights and colours are those of integrator/delta.glsl.
const int SCATTER_GRID_LAST_START = 4000;  // no walk begins in a turn after it
const float SCATTER_GRID_UNNEEDED = 2e6;   // alpha of nodes without media around: more than there are walks
const float SCATTER_GRID_SEEN = 0.25;      // of what the best seen node has: one that has more has all walks
const float SCATTER_GRID_LEAST = 0.03125;  // of all walks: what the camera hardly sees has so many

struct ScatterWalk {
    vec3 position, direction; // where the flight began, and where it looks
    Spectrum weight;
    MediaSpans spans;
    float at, end; // along the flight
    float least;   // samples per metre
    int scatterings;
    int iterations; // of a turn
};

void scatter_walk_turn(inout ScatterWalk walk, vec3 position, vec3 direction)
{
    walk.position = position;
    walk.direction = direction;
    walk.spans = media_spans(position, direction);
    vec2 interval = media_interval(walk.spans);
    walk.at = max(interval.x, 0.0);
    walk.end = interval.y;
    walk.least = WALK_SAMPLES / max(walk.end - walk.at, 1e-30);
}

// Flies to the next particle of the majorant, `depth` of its optical depths away, cell by cell. Returns the particles
// per metre there; 0 where the walk leaves the media before.
float scatter_walk_fly(inout ScatterWalk walk, float depth)
{
    while (walk.iterations < SCATTER_GRID_ITERATIONS && walk.at < walk.end) {
        ++walk.iterations;
        float edge = media_next_edge(walk.spans, walk.at, walk.end);
        vec3 here = walk.position + walk.at * walk.direction;
        float rate = walk_rate(walk.spans, here, walk.direction, walk.at, walk.least, edge);
        float within = rate * (edge - walk.at);
        if (depth < within) {
            walk.at += depth / rate;
            return rate;
        }
        depth -= within;
        walk.at = edge;
    }
    return 0.0;
}

// Light that would be scattered a `most`-th time at the node is the last that counts. Returns the light at one
// particle; the walk is over where its weight is 0.
Spectrum scatter_walk_meet(inout ScatterWalk walk, float rate, int most)
{
    vec3 here = walk.position + walk.at * walk.direction;
    MediaField field = media_field(walk.spans, here, walk.direction, walk.at);
    if (field.distance >= 0.0) {
        walk.at += field.distance;
        return spectrum(0.0);
    }
    Spectrum light = spectrum(0.0);
    if (walk.scatterings + 2 <= most) light = walk.weight * walk_emission(field, here) / rate;
    Spectrum extinction = walk_extinction(field);
    float odds = min(spectrum_mean(walk.weight * extinction) / (rate * spectrum_mean(walk.weight)), 1.0);
    if (odds <= 0.0 || walk_random() >= odds) {
        if (odds > 0.0) walk.weight *= max(1.0 - extinction / rate, spectrum(0.0)) / (1.0 - odds);
        return light;
    }
    // The last flight only looks for the sky.
    if (walk.scatterings + 2 > most) {
        walk.weight = spectrum(0.0);
        return light;
    }
    walk.weight /= rate * odds;
    ++walk.scatterings;
    walk_is_cleared = WALK_SIMILAR_AFTER > 0 && walk.scatterings >= WALK_SIMILAR_AFTER;
    light += walk.weight * walk_lit(field, here, walk.direction);
    vec3 turned = walk.direction;
    walk_scatter(field, here, walk.direction, walk.weight, turned);
    walk.weight = walk.scatterings + 1 < most || WALK_HAS_SKY ? scatter_walk_thin(walk.weight) : spectrum(0.0);
    walk_is_similar = walk_is_cleared;
    scatter_walk_turn(walk, here, turned);
    return light;
}

// The number of a node's walks, of which what the picture sees of it decides.
int scatter_grid_wanted(float seen)
{
    float most = SCATTER_GRID_SEEN * uintBitsToFloat(cache_sums[0]);
    float share = most > 0.0 ? clamp(seen / most, SCATTER_GRID_LEAST, 1.0) : 1.0;
    return int(ceil(share * scatter_grid_paths));
}

// Goes on with every SCATTER_GRID_LANES-th walk of one node, from `lane` on. `index` is the node's, `set` that of its
// phase function. Their first draws are evenly spread: the sequence of Roberts (The Unreasonable Effectiveness of
// Quasirandom Sequences, 2018) in three dimensions, shifted at random from node to node.
void scatter_grid_fill(ivec3 texel, int lane, uint index, vec3 node, float seen, int set, int most)
{
    const uvec3 STRIDES = uvec3(3518319155u, 2882110345u, 2360945575u); // 1 / x, 1 / x^2, 1 / x^3 with x^4 = x + 1
    vec4 kept = imageLoad(cache_image, texel);
    int all = scatter_grid_wanted(seen);
    int wanted = (all - lane + SCATTER_GRID_LANES - 1) / SCATTER_GRID_LANES;
    int walks = int(kept.a);
    if (seen < 0.0) {
        imageStore(cache_image, texel, vec4(0.0, 0.0, 0.0, SCATTER_GRID_UNNEEDED));
        return;
    }
    if (walks < 0 || walks >= wanted) return;
    if (walks == 0) atomicAdd(cache_sums[1], uint(wanted)); // once: a turn ends no lane without a walk
    vec3 away = node - camera_position;
    float apart = length(away);
    away = apart > 0.0 ? away / apart : vec3(0.0, 0.0, 1.0);
    walk_random_start(uvec2(index & 65535u, index >> 16u), 0xffffffffu, uint(set), 0u);
    uvec3 shift = uvec3(random_hash(walk_random_state), random_hash(walk_random_state + 1u),
                        random_hash(walk_random_state + 2u));
    Spectrum sum = walk_kept(kept.rgb);
    ScatterWalk walk;
    walk.at = 0.0;
    walk.end = -1.0;
    walk.weight = spectrum(0.0);
    walk.iterations = 0;
    bool goes = false;
    while (walk.iterations < SCATTER_GRID_ITERATIONS) {
        float share = 0.0;
        if (!goes) {
            if (walks >= wanted || walk.iterations > SCATTER_GRID_LAST_START) break;
            uint number = uint(lane + walks * SCATTER_GRID_LANES);
            walk_random_start(uvec2(index & 65535u, index >> 16u), number, uint(set), 0u);
            vec3 even = vec3((shift + number * STRIDES) >> 8u) * (1.0 / 16777216.0);
            vec3 toward;
            walk.weight = spectrum(walk_first(set, node, away, even.xy, toward));
            walk.scatterings = 0;
            walk_is_similar = walk_is_cleared = false;
            scatter_walk_turn(walk, node, toward);
            goes = true;
            share = even.z;
        } else {
            share = walk_random();
        }
        ++walk.iterations;
        float rate = scatter_walk_fly(walk, -log(1.0 - share));
        if (rate > 0.0) sum += scatter_walk_meet(walk, rate, most);
        if (walk.at >= walk.end || spectrum_max(walk.weight) <= 0.0) {
            if (walk.at >= walk.end) sum += walk.weight * walk_sky(walk.direction);
            goes = false;
            ++walks;
        }
    }
    atomicAdd(cache_sums[2], uint(walk.iterations + CACHE_STEPS / 2) / uint(CACHE_STEPS));
    if (goes) {
        imageStore(cache_image, texel, vec4(0.0, 0.0, 0.0, -1.0));
        return;
    }
    if (walks < wanted) cache_is_unfinished = 1u;
    float part = walks < wanted ? 1.0 : 1.0 / float(all);
    imageStore(cache_image, texel, vec4(spectrum_rgb(sum) * part, float(walks)));
}
