// Fills the grid of scattered light: from each node walks go out against the light, and gather what they meet. The
// mean over a node's walks has no bias, whatever the grid. A walk that ends makes room for the next one, so that one
// loop follows them all. Free flights and colours are those of integrator/delta.glsl.
const int SCATTER_GRID_LAST_START = 4000;  // steps of a turn after which no walk begins
const int SCATTER_GRID_CELLS = 12;         // of a flight, one after the other
const int SCATTER_GRID_TRIES = 256;        // parts without work, one after the other, that end a turn
const float SCATTER_GRID_UNNEEDED = 2e6;   // alpha of nodes without media around: more than there are walks
const float SCATTER_GRID_SEEN = 0.25;      // of what the best seen node has: one that has more has all walks
const float SCATTER_GRID_LEAST = 0.03125;  // of all walks: what the camera hardly sees has so many

struct ScatterWalk {
    vec3 position, direction; // where the flight began, and where it looks
    Spectrum weight;
    MediaSpans spans;
    MediaRay ray;
    float share;   // of the majorant that holds on this flight
    float at, end; // along the flight
    float least;   // samples per metre
    int scatterings;
    int iterations; // of the walk
};

void scatter_walk_turn(inout ScatterWalk walk, vec3 position, vec3 direction)
{
    walk.position = position;
    walk.direction = direction;
    walk.spans = media_spans(position, direction);
    walk.ray = media_ray(position, direction);
    walk.share = walk_rate_share();
    vec2 interval = media_interval(walk.spans);
    walk.at = max(interval.x, 0.0);
    walk.end = interval.y;
    walk.least = WALK_SAMPLES / max(walk.end - walk.at, 1e-30);
}

// Flies to the next particle of the majorant, `depth` of its optical depths away, cell by cell. Returns the particles
// per metre there; 0 where the walk leaves the media before, or goes on: of a flight through more cells than most,
// nothing is known but that, and walks that share a SIMD unit would wait for it.
float scatter_walk_fly(inout ScatterWalk walk, float depth)
{
    for (int cells = 0;
         cells < SCATTER_GRID_CELLS && walk.iterations < SCATTER_GRID_ITERATIONS && walk.at < walk.end; ++cells) {
        ++walk.iterations;
        float edge = media_next_edge(walk.spans, walk.at, walk.end);
        float rate = walk.share * media_rate(walk.spans, walk.ray, walk.at, walk.least, edge);
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

// A part of a node's walks: every SCATTER_GRID_LANES-th, from `lane` on. `wanted` are to be done, and `done` are.
struct ScatterPart {
    ivec3 texel;
    vec3 node, away; // from the camera
    uvec3 shift;     // of its first draws
    uvec2 node_index;
    int set, lane, all, wanted, done;
    Spectrum sum;
};

// Reads a part from its texel, which numbers it. False where nothing is left to do.
bool scatter_part_read(uint number, ivec3 size, out ScatterPart part)
{
    uint width = uint(size.x), height = uint(size.y);
    part.texel = ivec3(number % width, number / width % height, number / (width * height));
    ivec3 nodes = size / ivec3(SCATTER_GRID_LANES, 1, SCATTER_GRID_SETS);
    ivec3 at = ivec3(part.texel.x / SCATTER_GRID_LANES, part.texel.y, part.texel.z % nodes.z);
    float seen = texelFetch(scatter_seen, at, 0).r;
    if (seen < 0.0) {
        imageStore(cache_image, part.texel, vec4(0.0, 0.0, 0.0, SCATTER_GRID_UNNEEDED));
        return false;
    }
    vec4 kept = imageLoad(cache_image, part.texel);
    part.lane = part.texel.x % SCATTER_GRID_LANES;
    part.all = scatter_grid_wanted(seen);
    part.wanted = (part.all - part.lane + SCATTER_GRID_LANES - 1) / SCATTER_GRID_LANES;
    part.done = int(kept.a);
    if (part.done < 0 || part.done >= part.wanted) return false;
    if (part.done == 0) atomicAdd(cache_sums[1], uint(part.wanted)); // once: who has it begins a walk
    part.sum = walk_kept(kept.rgb);
    part.set = part.texel.z / nodes.z;
    part.node = scatter_grid_low + vec3(at) / vec3(nodes - 1) * scatter_grid_size;
    part.away = part.node - camera_position;
    float apart = length(part.away);
    part.away = apart > 0.0 ? part.away / apart : vec3(0.0, 0.0, 1.0);
    uint index = number / uint(SCATTER_GRID_LANES);
    part.node_index = uvec2(index & 65535u, index >> 16u);
    walk_random_start(part.node_index, 0xffffffffu, uint(part.set), 0u);
    part.shift = uvec3(random_hash(walk_random_state), random_hash(walk_random_state + 1u),
                       random_hash(walk_random_state + 2u));
    return true;
}

void scatter_part_keep(ScatterPart part)
{
    float share = part.done < part.wanted ? 1.0 : 1.0 / float(part.all);
    imageStore(cache_image, part.texel, vec4(spectrum_rgb(part.sum) * share, float(part.done)));
}

// Begins the part's next walk. First draws are evenly spread: the sequence of Roberts (The Unreasonable Effectiveness
// of Quasirandom Sequences, 2018) in three dimensions, shifted at random from node to node. Returns the third.
float scatter_part_begin(ScatterPart part, uint number, out ScatterWalk walk)
{
    const uvec3 STRIDES = uvec3(3518319155u, 2882110345u, 2360945575u); // 1 / x, 1 / x^2, 1 / x^3 with x^4 = x + 1
    walk_random_start(part.node_index, number, uint(part.set), 0u);
    vec3 even = vec3((part.shift + number * STRIDES) >> 8u) * (1.0 / 16777216.0);
    vec3 toward;
    walk.weight = spectrum(walk_first(part.set, part.node, part.away, even.xy, toward));
    walk.scatterings = 0;
    walk.iterations = 0;
    walk_is_similar = walk_is_cleared = false;
    scatter_walk_turn(walk, part.node, toward);
    return even.z;
}

// Takes parts until there is something to do in one. False where there is none, or the turn is over.
bool scatter_part_take(ivec3 size, inout int turn, out uint number, out ScatterPart part)
{
    uint parts = uint(size.x * size.y * size.z);
    for (int i = 0; i < SCATTER_GRID_TRIES; ++i) {
        ++turn;
        number = cache_take();
        if (number >= parts) break;
        if (scatter_part_read(number, size, part)) return true;
    }
    return false;
}

// Does parts of nodes, one after the other, so that no processor waits for another that has more to do. A turn ends
// with a part that is not done; who takes it next goes on with it. Light that would be scattered a `most`-th time at
// the node is the last that counts.
void scatter_grid_fill(int most)
{
    ivec3 size = imageSize(cache_image);
    ScatterPart part;
    ScatterWalk walk;
    bool has_part = false, goes = false;
    uint taken = 0u, number = 0u, steps = 0u; // the part's number, that of the walk, and what is counted
    int turn = 0;
    while (goes || turn < SCATTER_GRID_LAST_START) {
        if (!has_part) has_part = scatter_part_take(size, turn, taken, part);
        if (!has_part) break;
        float share = 0.0;
        if (!goes) {
            number = uint(part.lane + part.done * SCATTER_GRID_LANES);
            share = scatter_part_begin(part, number, walk);
            goes = true;
        } else {
            share = walk_random();
        }
        ++walk.iterations;
        float rate = scatter_walk_fly(walk, -log(1.0 - share));
        if (rate > 0.0) part.sum += scatter_walk_meet(walk, rate, most);
        bool is_out = walk.at >= walk.end;
        if (is_out || spectrum_max(walk.weight) <= 0.0) {
            if (is_out) part.sum += walk.weight * walk_sky(walk.direction);
            ++part.done;
            turn += walk.iterations;
            steps += (uint(walk.iterations) + number % uint(CACHE_STEPS)) / uint(CACHE_STEPS);
            goes = false;
            if (part.done == part.wanted) {
                scatter_part_keep(part);
                has_part = false;
            }
        } else if (walk.iterations >= SCATTER_GRID_ITERATIONS) {
            imageStore(cache_image, part.texel, vec4(0.0, 0.0, 0.0, -1.0));
            turn += walk.iterations;
            goes = has_part = false;
        }
    }
    atomicAdd(cache_sums[2], steps);
    if (!has_part) return;
    if (goes) { // a driver ended the loop
        imageStore(cache_image, part.texel, vec4(0.0, 0.0, 0.0, -1.0));
        return;
    }
    scatter_part_keep(part);
    cache_leave(taken);
}
