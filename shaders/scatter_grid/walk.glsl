// Fills the grid of scattered light: from each node walks go out against the light, and gather what they meet. The
// mean over a node's walks has no bias, whatever the grid. One iteration is one step of a free flight; a walk that ends
// makes room for the node's next one. Free flights and colours are those of integrator/delta.glsl.
const int SCATTER_GRID_ITERATIONS = 20000; // of one turn: some drivers end loops after 65,535
const int SCATTER_GRID_LAST_START = 5000;  // no walk begins in a turn after it
const float SCATTER_GRID_FAINT = 0.25;     // a walk that carries less ends at random

struct ScatterWalk {
    vec3 position, direction; // where the flight began, and where it looks
    Spectrum weight;
    MediaSpans spans;
    float at, end; // along the flight
    float least;   // samples per metre
    int scatterings;
};

// What is fainter than SCATTER_GRID_FAINT ends at random, and is weighted where it goes on, which keeps the mean.
Spectrum scatter_walk_thin(Spectrum weight)
{
    float most = spectrum_max(weight);
    if (most >= SCATTER_GRID_FAINT) return weight;
    return walk_random() * SCATTER_GRID_FAINT < most ? weight * (SCATTER_GRID_FAINT / most) : spectrum(0.0);
}

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

// Light that would be scattered a `most`-th time at the node is the last that counts. Returns the light of one step;
// the walk is over where its weight is 0.
Spectrum scatter_walk_step(inout ScatterWalk walk, int most)
{
    float edge = media_next_edge(walk.spans, walk.at, walk.end);
    vec3 here = walk.position + walk.at * walk.direction;
    float rate = media_rate(walk.spans, here, walk.direction, walk.at, walk.least, edge);
    float flight = (rate > 0.0 ? -log(1.0 - walk_random()) / rate : FAR_AWAY);
    if (walk.at + flight >= edge) {
        walk.at = edge;
        if (edge >= walk.end) walk.weight = spectrum(0.0);
        return spectrum(0.0);
    }
    walk.at += flight;
    here = walk.position + walk.at * walk.direction;
    MediaField field = media_field(walk.spans, here, walk.direction, walk.at);
    if (field.distance >= 0.0) {
        walk.at += field.distance;
        return spectrum(0.0);
    }
    Spectrum light = spectrum(0.0);
    if (walk.scatterings + 2 <= most) light = walk.weight * walk_emission(field, here) / rate;
    Spectrum extinction = media_extinction(field);
    float odds = min(spectrum_mean(walk.weight * extinction) / (rate * spectrum_mean(walk.weight)), 1.0);
    if (odds <= 0.0 || walk_random() >= odds) {
        if (odds > 0.0) walk.weight *= max(1.0 - extinction / rate, spectrum(0.0)) / (1.0 - odds);
        return light;
    }
    walk.weight /= rate * odds;
    ++walk.scatterings;
    light += walk.weight * walk_lit(field, here, walk.direction);
    vec3 turned = walk.direction;
    walk_scatter(field, walk.direction, walk.weight, turned);
    walk.weight = walk.scatterings + 1 < most ? scatter_walk_thin(walk.weight) : spectrum(0.0);
    scatter_walk_turn(walk, here, turned);
    return light;
}

// Goes on with the walks of one node. `index` is the node's, `set` that of its phase function.
void scatter_grid_fill(ivec3 texel, uint index, vec3 node, int set, int most)
{
    vec4 kept = imageLoad(cache_image, texel);
    int wanted = int(scatter_grid_paths);
    int walks = int(kept.a);
    if (walks < 0 || walks >= wanted) return;
    vec3 away = node - camera_position;
    float apart = length(away);
    away = apart > 0.0 ? away / apart : vec3(0.0, 0.0, 1.0);
    Spectrum sum = walk_kept(kept.rgb);
    ScatterWalk walk;
    bool goes = false;
    for (int iteration = 0; iteration < SCATTER_GRID_ITERATIONS; ++iteration) {
        if (!goes) {
            if (walks >= wanted || iteration > SCATTER_GRID_LAST_START) break;
            walk_random_start(uvec2(index & 65535u, index >> 16u), uint(walks), uint(set), 0u);
            walk.weight = spectrum(1.0);
            walk.scatterings = 0;
            scatter_walk_turn(walk, node, walk_first(set, away));
            goes = true;
        }
        if (walk.at < walk.end) sum += scatter_walk_step(walk, most);
        if (walk.at >= walk.end || spectrum_max(walk.weight) <= 0.0) {
            goes = false;
            ++walks;
        }
    }
    if (goes) {
        imageStore(cache_image, texel, vec4(0.0, 0.0, 0.0, -1.0));
        return;
    }
    if (walks < wanted) cache_is_unfinished = 1u;
    float share = walks < wanted ? 1.0 : 1.0 / float(wanted);
    imageStore(cache_image, texel, vec4(spectrum_rgb(sum) * share, float(walks)));
}
