// Fills the grid of scattered light from the lights: particles fly out, are scattered, and leave in each cell about a
// node that they cross what they carry times the length of their way there. Over the cell's volume that is the light
// which passes it: the estimator of track lengths (Spanier and Gelbard, Monte Carlo Principles and Neutron Transport
// Problems, 1969). Sums are whole numbers of 64 bits, so that their order does not matter.
const float SCATTER_SUM_UNIT = 1048576.0; // for a weight of 1 along a cell, evenly scattered
const float SCATTER_SUM_WORD = 4294967296.0;

struct ScatterSent {
    vec3 position, direction;
    Spectrum weight;
    int light;
    int scatterings;
    MediaSpans spans;
    MediaRay ray;
    vec2 media;      // the interval of these
    float at, end;   // along the flight
    float entry;     // where it enters the cells
    float clear;     // there is nothing before
    ivec3 cell;      // of the next part of the flight,
    vec3 edges;      // which ends at the least of these distances
    int iterations;  // of a turn
};

void scatter_sum_add(int at, float value)
{
    float scaled = value * SCATTER_SUM_UNIT + 0.5;
    if (!(scaled < 1e18)) {
        cache_sums[0] = 1u;
        return;
    }
    uint high = uint(scaled / SCATTER_SUM_WORD);
    uint low = uint(scaled - float(high) * SCATTER_SUM_WORD);
    if (low > 0u && atomicAdd(cache_sums[at], low) > 0xffffffffu - low) ++high;
    if (high > 0u) atomicAdd(cache_sums[at + 1], high);
}

// Light from afar flies through media before its position, too.
void scatter_sent_turn(inout ScatterSent sent, vec3 position, vec3 direction, bool is_from_afar)
{
    vec3 cell = scatter_cell_size();
    vec3 from = (position - scatter_cells_low()) / cell;
    vec3 slope = direction / cell;
    slope = mix(vec3(1e-20), slope, greaterThan(abs(slope), vec3(1e-20)));
    vec3 first = -from / slope;
    vec3 last = (scatter_grid_nodes - from) / slope;
    vec3 near = min(first, last);
    vec3 far = max(first, last);
    sent.position = position;
    sent.direction = direction;
    sent.spans = media_spans(position, direction);
    sent.ray = media_ray(position, direction);
    sent.media = media_interval(sent.spans);
    sent.at = is_from_afar ? min(sent.media.x, 0.0) : 0.0;
    sent.entry = max(max(near.x, near.y), near.z);
    sent.end = min(min(far.x, far.y), far.z);
    if (sent.entry >= sent.end) sent.end = sent.at;
    sent.clear = sent.at;
    vec3 place = from + max(sent.at, sent.entry) * slope;
    sent.cell = clamp(ivec3(floor(place)), ivec3(0), ivec3(scatter_grid_nodes) - 1);
    sent.edges = (vec3(sent.cell) + step(0.0, slope) - from) / slope;
}

// What the particle leaves in its cell, for each set of the grid's values.
void scatter_sent_leave(ScatterSent sent, float to)
{
    ivec3 nodes = ivec3(scatter_grid_nodes);
    ivec3 cell = clamp(sent.cell, ivec3(0), nodes - 1);
    int index = cell.x + nodes.x * (cell.y + nodes.y * cell.z);
    vec3 away = camera_position - sent.position - 0.5 * (sent.at + to) * sent.direction;
    vec3 toward = away * inversesqrt(max(dot(away, away), 1e-30));
    Spectrum left = sent.weight * ((to - sent.at) / (INV_4PI * scatter_cell_size().x));
    for (int set = 0; set < SCATTER_GRID_SETS; ++set) {
        vec3 seen = spectrum_rgb(left * walk_phase(set, sent.direction, toward));
        int at = 2 + 2 * SCATTER_GRID_CHANNELS * (index + set * nodes.x * nodes.y * nodes.z);
        for (int channel = 0; channel < SCATTER_GRID_CHANNELS; ++channel)
            scatter_sum_add(at + 2 * channel, seen[channel]);
    }
}

// Flies to the next particle of the majorant, `depth` of its optical depths away, cell by cell. Returns the particles
// per metre there; 0 where the flight leaves the cells before.
float scatter_sent_fly(inout ScatterSent sent, float depth)
{
    bool counts = sent.scatterings > 0 || walk_is_first(sent.light);
    while (sent.iterations < SCATTER_GRID_ITERATIONS && sent.at < sent.end) {
        ++sent.iterations;
        float edge = media_next_edge(sent.spans, sent.at, span_next_edge(sent.media, sent.at, sent.end));
        float rate = 0.0;
        if (sent.at < sent.clear)
            edge = min(edge, sent.clear);
        else
            rate = media_rate(sent.spans, sent.ray, sent.at, 0.0, edge);
        bool is_inside = sent.at >= sent.entry;
        float side = min(min(sent.edges.x, sent.edges.y), sent.edges.z);
        edge = max(min(edge, is_inside ? side : sent.entry), sent.at);
        float within = rate * (edge - sent.at);
        bool is_met = depth < within;
        float to = is_met ? sent.at + depth / rate : edge;
        if (is_inside && counts && to > sent.at) scatter_sent_leave(sent, to);
        sent.at = to;
        if (is_met) return rate;
        depth -= within;
        if (is_inside && to >= side) {
            vec3 crossed = vec3(lessThanEqual(sent.edges, vec3(side)));
            sent.cell += ivec3(crossed * sign(sent.direction));
            sent.edges += crossed * scatter_cell_size() / max(abs(sent.direction), vec3(1e-20));
        }
    }
    return 0.0;
}

// The particle is scattered, or flies on. It is over where its weight is 0.
void scatter_sent_meet(inout ScatterSent sent, float rate, int most)
{
    vec3 here = sent.position + sent.at * sent.direction;
    MediaField field = media_field(sent.spans, here, sent.direction, sent.at);
    if (field.distance >= 0.0) {
        sent.clear = sent.at + field.distance;
        return;
    }
    Spectrum extinction = media_extinction(field);
    float odds = min(spectrum_mean(sent.weight * extinction) / (rate * spectrum_mean(sent.weight)), 1.0);
    if (odds <= 0.0 || walk_random() >= odds) {
        if (odds > 0.0) sent.weight *= max(1.0 - extinction / rate, spectrum(0.0)) / (1.0 - odds);
        return;
    }
    // What is left in the cells is scattered once more.
    if (sent.scatterings + 2 > most) {
        sent.weight = spectrum(0.0);
        return;
    }
    sent.weight /= rate * odds;
    if (sent.scatterings == 0) sent.weight *= walk_fall(sent.light, here);
    ++sent.scatterings;
    vec3 turned = sent.direction;
    walk_scatter(field, here, sent.direction, sent.weight, turned);
    sent.weight = scatter_walk_thin(sent.weight);
    scatter_sent_turn(sent, here, turned, false);
}

// The next particle of an invocation. Those of one light are evenly spread: the sequence of Roberts (The Unreasonable
// Effectiveness of Quasirandom Sequences, 2018) in three dimensions. Returns the share that is its first flight's.
float scatter_sent_begin(inout ScatterSent sent, uint index, float fraction, float all)
{
    const uvec3 STRIDES = uvec3(3518319155u, 2882110345u, 2360945575u); // 1 / x, 1 / x^2, 1 / x^3 with x^4 = x + 1
    float rest = fraction * all;
    vec3 even = vec3((index * STRIDES) >> 8u) * (1.0 / 16777216.0);
    sent.light = 0;
    while (sent.light < WALK_LIGHTS - 1 && rest >= walk_powers[sent.light]) rest -= walk_powers[sent.light++];
    sent.scatterings = 0;
    ScatterSource source;
    bool is_from_afar = walk_begin(sent.light, even.xy, source, sent.weight);
    sent.weight *= source.measure / max(walk_powers[sent.light], 1e-30);
    scatter_sent_turn(sent, source.position, source.direction, is_from_afar);
    return even.z;
}

// Goes on with the particles of one invocation. A particle that is under way when a turn ends is kept.
void scatter_grid_send(ivec3 place, int most)
{
    vec4 kept = imageLoad(cache_image, ivec3(place.xy, 0));
    int wanted = int(scatter_grid_sent), sent_count = int(kept.x);
    bool goes = kept.w > 0.0;
    if (sent_count >= wanted) return;
    uint index = uint(place.x + place.y * cache_invocations.x);
    uint others = uint(cache_invocations.x * cache_invocations.y);
    float all = walk_powers_find();
    ScatterSent sent;
    sent.at = 0.0;
    sent.end = -1.0;
    sent.weight = spectrum(0.0);
    sent.iterations = 0;
    sent.light = int(kept.z);
    sent.scatterings = int(kept.y);
    walk_random_start(uvec2(index & 65535u, index >> 16u), uint(sent_count), 0x5e7du, 0u);
    if (goes) {
        vec4 from = imageLoad(cache_image, ivec3(place.xy, 1)), ahead = imageLoad(cache_image, ivec3(place.xy, 2));
        sent.weight = walk_kept(imageLoad(cache_image, ivec3(place.xy, 3)).rgb);
        scatter_sent_turn(sent, from.xyz, ahead.xyz, false);
        walk_random_resume(uint(from.w) | (uint(ahead.w) << 16u));
    }
    if (all <= 0.0) sent_count = wanted;
    while (sent.iterations < SCATTER_GRID_ITERATIONS && (goes || sent_count < wanted)) {
        float share;
        if (!goes) {
            walk_random_start(uvec2(index & 65535u, index >> 16u), uint(sent_count), 0x5e7du, 0u);
            float fraction = (float(sent_count) + (float(index) + 0.5) / float(others)) / float(wanted);
            share = scatter_sent_begin(sent, index + others * uint(sent_count), fraction, all);
            goes = true;
        } else {
            share = walk_random();
        }
        ++sent.iterations;
        float rate = scatter_sent_fly(sent, -log(1.0 - share));
        if (rate > 0.0) scatter_sent_meet(sent, rate, most);
        if (sent.at >= sent.end || spectrum_max(sent.weight) <= 0.0) {
            goes = false;
            ++sent_count;
        }
    }
    if (sent_count < wanted) cache_is_unfinished = 1u;
    imageStore(cache_image, ivec3(place.xy, 0), vec4(sent_count, sent.scatterings, sent.light, goes ? 1.0 : 0.0));
    imageStore(cache_image, ivec3(place.xy, 1),
               vec4(sent.position + sent.at * sent.direction, float(walk_random_state & 65535u)));
    imageStore(cache_image, ivec3(place.xy, 2), vec4(sent.direction, float(walk_random_state >> 16u)));
    imageStore(cache_image, ivec3(place.xy, 3), vec4(spectrum_rgb(sent.weight), all));
}
