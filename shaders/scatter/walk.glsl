// Random paths through media, followed against the light: the radiance that arrives, with every order of scattering up
// to a limit. Unbiased. Free flights among a majorant of particles (Woodcock et al. 1965) end at collisions that
// scatter; at each of them a light is sampled, and its transmittance estimated (Novak, Selle and Jarosz 2014).
// Colours share all draws; odds follow the mean of what each still carries, which keeps weights bounded: Kutz, Habel,
// Li and Novak, ACM Transactions on Graphics 36(4), 2017. Absorption only takes weight away.

// Sums over paths, and the flight with which the path goes on that is not over.
struct Walk {
    Spectrum light;
    Spectrum passed; // transmittance of the rays that begin at negative numbers; of a layer, half its paths' light
    vec2 depth;      // the distances where it fell to one half, and their number; behind these rays, their mean and 1
    int path, order; // its number, and its scatterings so far
    vec3 origin, direction;
    float at; // distance along the flight
    Spectrum weight;
    uint random; // state of the random numbers
    uint left;   // the shapes on whose boundary `origin` lies, a bit each
    float aimed; // of this flight: the density of second paths that might fly so, relative to that of this one
};

const int WALK_LIMIT = 3 * WALK_TURNS; // a flight to a light may go on to so many
const float WALK_FAINT = 0.1; // of a light's contribution: less of it ends at random
const float WALK_WEAK = 0.25; // of a path's beginning: less of it ends at random

uint walk_steps = 0u; // that were taken here, as walks from nodes count theirs

Walk walk_none(int passes)
{
    return Walk(spectrum(0.0), spectrum(0.0), vec2(0.0), -passes - 1, 0, vec3(0.0), vec3(0.0, 0.0, 1.0), FAR_AWAY,
                spectrum(0.0), 0u, 0u, 0.0);
}

// The mean distance where most of the rays' transmittance fell to one half, and 1; else 0.
vec2 walk_depth(vec2 depth, int passes)
{
    return 2.0 * depth.y > float(passes) ? vec2(depth.x / depth.y, 1.0) : vec2(0.0);
}

// What is weaker than `least` ends at random, and is weighted where it goes on, which keeps the mean.
Spectrum walk_thin(Spectrum weight, float least)
{
    float most = spectrum_max(weight);
    if (most >= least) return weight;
    return walk_random() * least < most ? weight * (least / most) : spectrum(0.0);
}

// The light of a flight of `weight` that the media emit at a point where the flight has one of `rate` samples a metre,
// and whether it is scattered there. The weight becomes that of what happens.
bool walk_meet(MediaField field, vec3 point, float rate, bool is_aside, inout Walk walk)
{
    Spectrum thin = max(1.0 - walk_extinction(field) / rate, spectrum(0.0));
    if (!is_aside && (walk.order > 0 || !WALK_IS_LAYER)) walk.light += walk.weight * walk_emission(field, point) / rate;
    float scattered = spectrum_mean(walk.weight * walk_scattering(field)) / rate;
    float odds = scattered / max(scattered + spectrum_mean(walk.weight * thin), 1e-30);
    bool is_met = odds > 0.0 && walk_random() < odds;
    walk.weight *= is_met ? spectrum(1.0 / (rate * odds)) : thin / (1.0 - odds);
    return is_met;
}

// The same, with the light that is known to reach the point: where it is looked up without a flight, what is expected
// at each of the majorant's particles has less noise than what is found where the path is scattered.
bool walk_reach(WalkVertex met, vec3 point, float rate, bool is_aside, inout Walk walk)
{
    if (WALK_GATHERS) walk_known(point, walk.direction, met, walk.weight / (rate * (1.0 + walk.aimed)), walk.light);
    return walk_meet(met.field, point, rate, is_aside, walk);
}

// The light of all paths before, and of the latest one or a part of it. The share is no number of the path's.
Spectrum walk_sum(Spectrum before, Spectrum more)
{
    uint bits = random_hash(walk_random_state + 0x9e3779b9u);
    return scatter_sum(before, more, float(bits >> 8u) * (1.0 / 16777216.0));
}

// What a flight is for.
const int WALK_ON = 0;    // the path goes on, or a ray is followed for its transmittance
const int WALK_LIGHT = 1; // from a vertex to a light
const int WALK_NEAR = 2;  // from a vertex to one that is drawn near a lamp
const int WALK_LAMP = 3;  // from there to the lamp
const int WALK_ASIDE = 4; // a second path, which ends before the first one goes on

// Adds `passes` rays' transmittance and the light of `count` paths of at most `orders` scatterings, one after the
// other, from walk_none(passes) on. walk_start(path) says where each begins; its numbers run from -passes to count - 1.
// Light that no medium scattered is only that which media emit. Returns false where the work is to be continued, with
// the same `walk`. A single loop follows all kinds of flight: its look at the media is there once.
bool walk_on(inout Walk walk, int passes, int count, int orders)
{
    int kind = WALK_ON;
    vec3 vertex = vec3(0.0);         // where the path waits while lights are sampled there
    uint left = 0u;
    vec3 ahead = vec3(0.0);          // its direction behind the vertex
    Spectrum behind = spectrum(0.0); // its weight
    WalkNear near = WalkNear(vec3(0.0), 0.0, 0.0, 0); // the vertex near a lamp that is next
    Spectrum nearby = spectrum(0.0);               // the weight of the flight there
    float faint = 0.0;
    Spectrum beside = spectrum(0.0); // the weight of the second path that is sent from there,
    vec3 toward = vec3(0.0);         // and its direction
    float aimed = 0.0;               // of the path's own direction,
    float aimed_beside = 0.0;        // and of that
    int order = 0;                   // of the vertex
    vec2 begin = vec2(0.0, FAR_AWAY); // where media count on the path's first flight
    vec2 interval = begin;
    Spectrum sum = walk.light; // of the paths before
    walk.light = spectrum(0.0);
    walk_near_find();
    if (walk.path >= -passes) {
        begin = walk_start(walk.path).interval;
        if (walk.order == 0) interval = begin;
        walk_random_resume(walk.random);
    }
    MediaSpans spans = media_spans(walk.origin, walk.direction);
    MediaRay ray = media_ray(walk.origin, walk.direction);
    WalkWall wall = walk_wall(walk.origin, walk.direction, walk.left);
    float end = min(min(media_interval(spans).y, interval.y), wall.at);
    float least = walk_least(end - max(media_interval(spans).x, interval.x)); // samples per metre
    for (int turn = 0; turn < (kind == WALK_ON ? WALK_TURNS : WALK_LIMIT) && walk.path < count; ++turn) {
        bool is_met = false; // the path is scattered, or the vertex near a lamp is reached
        bool goes_near = WALK_FLIES && kind == WALK_NEAR;
        WalkVertex met;
        // Rays that share a SIMD unit wait here for one another, so that they turn together.
        for (int flights = 0; flights < WALK_FLIGHTS && (walk.at < end || goes_near); ++flights) {
            ++walk_steps;
            float rate = 0.0;
            float depth = -log(1.0 - walk_random()); // of the flight, among the majorant's particles
            for (int cells = 0; cells < WALK_CELLS && walk.at < end; ++cells) {
                ++walk_steps;
                float edge = media_next_edge(spans, walk.at, end);
                rate = media_rate(spans, ray, walk.at, least, edge);
                float within = rate * (edge - walk.at);
                if (depth < within) break;
                depth -= within;
                walk.at = edge;
                rate = 0.0;
            }
            is_met = goes_near && walk.at >= end;
            if (rate <= 0.0 && !is_met) continue; // of a flight that goes on, nothing is known but that
            if (!is_met) walk.at += depth / rate;
            vec3 point = walk.origin + walk.at * walk.direction;
            met = walk_vertex(media_field(spans, point, walk.direction, walk.at));
            if (is_met) break;
            if (met.field.distance < 0.0) {
                float was = spectrum_mean(walk.weight);
                if ((WALK_FLIES && kind != WALK_ON && kind != WALK_ASIDE) || walk.path < 0)
                    walk.weight *= max(1.0 - walk_extinction(met.field) / rate, spectrum(0.0));
                else
                    is_met = walk_reach(met, point, rate, WALK_SENDS && kind == WALK_ASIDE, walk);
                if (is_met) break;
                walk.weight = walk_thin(walk.weight, faint);
                if (walk.path < 0 && was > 0.5 && spectrum_mean(walk.weight) <= 0.5) walk.depth += vec2(walk.at, 1.0);
                if (spectrum_max(walk.weight) <= 0.0) break;
            }
            walk.at += max(met.field.distance, 0.0);
        }
        bool is_over = walk.at >= end || spectrum_max(walk.weight) <= 0.0;
        if (!is_met && !is_over) continue;
        if (!is_met && kind == WALK_ON && wall.at < FAR_AWAY && walk.at >= end && spectrum_max(walk.weight) > 0.0) {
            if (walk.path >= 0) {
                is_met = walk_meet_wall(wall, walk.origin + wall.at * walk.direction, walk.direction, met);
                walk.at = wall.at;
            } else if (walk.path >= -passes) {
                if (spectrum_mean(walk.weight) > 0.5) walk.depth += vec2(wall.at, 1.0);
                walk.weight = spectrum(0.0);
            }
        }
        interval = vec2(0.0, FAR_AWAY);
        if (is_met) {
            walk.origin += walk.at * walk.direction;
            walk.left = met.left;
            LightSample light = LightSample(walk.direction, 0.0, spectrum(0.0));
            Spectrum lit = spectrum(0.0);
            if (goes_near) {
                lit = walk_lamp(near.lamp, walk.origin, walk.direction, met, walk.weight, light, walk.light);
                kind = WALK_LAMP;
            } else if (WALK_SENDS && kind == WALK_ASIDE) {
                ++walk.order;
                if (!WALK_GATHERS)
                    walk_known(walk.origin, walk.direction, met, walk.weight / (1.0 + walk.aimed), walk.light);
                if (walk.order < orders && walk_random() < walk_aside_goes_on()) {
                    lit = walk_turn(walk.origin, walk.direction, met, walk.weight, walk.order, light.direction);
                    light.distance = FAR_AWAY;
                    walk.aimed = walk_aside_goes_on() * walk.aimed +
                                 walk_aside_density(walk.origin, walk.direction, met, walk.weight, light.direction);
                }
            } else {
                ++walk.order;
                vertex = walk.origin;
                left = walk.left;
                if (!WALK_GATHERS || met.left != 0u)
                    walk_known(vertex, walk.direction, met, walk.weight / (1.0 + walk.aimed), walk.light);
                lit = walk_light(vertex, walk.direction, met, walk.weight, light);
                behind = spectrum(0.0);
                nearby = spectrum(0.0);
                beside = spectrum(0.0);
                if (walk.order < orders) {
                    nearby = walk_near(vertex, walk.direction, met, walk.weight, near, walk.light);
                    behind = walk_turn(vertex, walk.direction, met, walk.weight, walk.order, ahead);
                    if (WALK_SENDS) {
                        float before = walk_aside_goes_on() * walk.aimed;
                        aimed = before + walk_aside_density(vertex, walk.direction, met, walk.weight, ahead);
                        beside = walk_aside(vertex, walk.direction, met, walk.weight, toward);
                        if (spectrum_max(beside) > 0.0)
                            aimed_beside =
                                before + walk_aside_density(vertex, walk.direction, met, walk.weight, toward);
                        order = walk.order;
                    }
                    behind = walk_thin(behind, WALK_WEAK);
                }
                kind = WALK_LIGHT;
            }
            walk.direction = light.direction;
            interval.y = light.distance;
            walk.weight = lit;
            faint = kind == WALK_ASIDE ? 0.0 : WALK_FAINT * spectrum_max(lit);
            is_over = spectrum_max(lit) <= 0.0;
        }
        if (is_over) {
            if (kind == WALK_LIGHT || kind == WALK_LAMP) walk.light += walk.weight;
            if (walk.path < 0 && walk.path >= -passes) walk.passed += walk.weight;
            interval = vec2(0.0, FAR_AWAY);
            if (kind == WALK_ON || spectrum_max(behind + nearby + beside) <= 0.0) {
                ++walk.path;
                walk.order = 0;
                if (walk.path == 0) walk.depth = walk_depth(walk.depth, passes);
                sum = walk_sum(sum, walk.light);
                walk.light = spectrum(0.0);
                if (WALK_IS_LAYER && walk.path == count / 2) walk.passed = sum;
                WalkRay next = walk_start(walk.path);
                vertex = next.origin;
                left = 0u;
                ahead = next.direction;
                begin = next.interval;
                behind = spectrum(1.0);
                nearby = spectrum(0.0);
                beside = spectrum(0.0);
                aimed = 0.0;
                order = 0;
                if (walk.path >= 0 && walk.path < count) nearby = walk_near_start(next, near, walk.light);
            }
            bool is_near = spectrum_max(nearby) > 0.0;
            bool is_aside = WALK_SENDS && !is_near && spectrum_max(beside) > 0.0;
            kind = is_near ? WALK_NEAR : is_aside ? WALK_ASIDE : WALK_ON;
            walk.origin = vertex;
            walk.left = left;
            walk.direction = is_near ? near.direction : is_aside ? toward : ahead;
            walk.weight = is_near ? nearby : is_aside ? beside : behind;
            if (WALK_SENDS) {
                walk.order = order;
                walk.aimed = is_aside ? aimed_beside : aimed;
                if (is_aside) beside = spectrum(0.0);
            }
            if (walk.order == 0) interval = begin;
            if (is_near) interval.y = near.distance;
            faint = is_near ? WALK_FAINT * spectrum_max(nearby) : 0.0;
            nearby = spectrum(0.0);
        }
        spans = media_spans(walk.origin, walk.direction);
        ray = media_ray(walk.origin, walk.direction);
        vec2 stretch = media_interval(spans);
        walk.at = max(stretch.x, interval.x);
        wall = walk_wall(walk.origin, walk.direction, walk.left);
        end = min(min(stretch.y, interval.y), wall.at);
        least = walk_least(end - walk.at);
        if (kind != WALK_ON && wall.limit < interval.y) {
            walk.weight = spectrum(0.0);
            walk.at = end;
        }
        if (kind == WALK_NEAR) {
            if (interval.y < stretch.x || interval.y >= stretch.y) walk.weight = spectrum(0.0);
            end = interval.y;
        }
    }
    walk.random = walk_random_state;
    walk.light = walk_sum(sum, walk.light);
    if (kind != WALK_ON) march_was_cut = true;
    return walk.path >= count;
}
