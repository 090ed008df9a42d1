// Random paths through media, followed against the light: the radiance that arrives, with every order of scattering up
// to a limit. Unbiased. Free flights among a majorant of particles (Woodcock et al. 1965) end at collisions that
// scatter; at each of them a light is sampled, and its transmittance estimated (Novak, Selle and Jarosz 2014).
// Colours share all draws; odds follow the mean of what each still carries, which keeps weights bounded: Kutz, Habel,
// Li and Novak, ACM Transactions on Graphics 36(4), 2017. Absorption only takes weight away.

// Sums over paths.
struct WalkSums {
    Spectrum light;
    Spectrum passed; // transmittance of the rays that began at negative numbers
    vec2 depth;      // the distances where it fell to one half, and their number
};

const int WALK_LIMIT = 60000;  // iterations of all loops
const float WALK_FAINT = 0.1;  // of a light's contribution: less of it ends at random
const float WALK_WEAK = 0.25;  // of a path's beginning: less of it ends at random

// What is weaker than `least` ends at random, and is weighted where it goes on, which keeps the mean.
Spectrum walk_thin(Spectrum weight, float least)
{
    float most = spectrum_max(weight);
    if (most >= least) return weight;
    return walk_random() * least < most ? weight * (least / most) : spectrum(0.0);
}

// Follows `passes` rays for their transmittance and `count` paths of at most `orders` scatterings, one after the other.
// walk_start(path) says where each begins; its numbers run from -passes to count - 1. Light that no medium scattered is
// only that which media emit. A single loop follows all kinds of flight: its look at the media is there once.
WalkSums walk(int passes, int count, int orders)
{
    WalkSums sums = WalkSums(spectrum(0.0), spectrum(0.0), vec2(0.0));
    int path = -passes - 1;
    int order = 0;
    bool is_shadow = false;
    vec3 origin = vec3(0.0);
    vec3 direction = vec3(0.0, 0.0, 1.0);
    MediaSpans spans = media_spans(origin, direction);
    float at = 0.0;
    float end = 0.0;
    float least = 0.0; // samples per metre
    float faint = 0.0;
    Spectrum weight = spectrum(0.0);
    vec3 ahead = direction; // the path's direction behind a vertex, while a light is sampled there
    Spectrum behind = spectrum(0.0); // its weight
    int iteration = 0;
    for (; iteration < WALK_LIMIT && path < count; ++iteration) {
        float rate = 0.0;
        bool is_met = false;
        MediaField field;
        // Rays that share a SIMD unit wait here for one another, so that all of them turn together.
        for (; iteration < WALK_LIMIT && at < end; ++iteration) {
            float edge = media_next_edge(spans, at, end);
            rate = media_rate(spans, origin + at * direction, direction, at, least, edge);
            float flight = rate > 0.0 ? -log(1.0 - walk_random()) / rate : FAR_AWAY;
            if (at + flight >= edge) {
                at = edge;
                continue;
            }
            at += flight;
            field = media_field(spans, origin + at * direction, direction, at);
            if (field.distance < 0.0) {
                Spectrum thin = max(1.0 - walk_extinction(field) / rate, spectrum(0.0));
                float odds = 0.0;
                if (!is_shadow && path >= 0) {
                    sums.light += weight * walk_emission(field, origin + at * direction) / rate;
                    float scattered = spectrum_mean(weight * walk_scattering(field)) / rate;
                    odds = scattered / max(scattered + spectrum_mean(weight * thin), 1e-30);
                }
                is_met = odds > 0.0 && walk_random() < odds;
                if (is_met) {
                    weight /= rate * odds;
                    break;
                }
                bool was_more = spectrum_mean(weight) > 0.5;
                weight = walk_thin(weight * (thin / (1.0 - odds)), faint);
                if (path < 0 && was_more && spectrum_mean(weight) <= 0.5) sums.depth += vec2(at, 1.0);
                if (spectrum_max(weight) <= 0.0) break;
            }
            at += max(field.distance, 0.0);
        }
        if (iteration >= WALK_LIMIT) break;
        vec2 interval = vec2(0.0, FAR_AWAY);
        if (is_met) {
            ++order;
            origin += at * direction;
            LightSample light = LightSample(direction, 0.0, spectrum(0.0));
            Spectrum lit = walk_light(origin, direction, field, weight, light);
            behind = spectrum(0.0);
            if (order < orders) behind = walk_thin(walk_scatter(field, direction, weight, ahead), WALK_WEAK);
            is_shadow = true;
            direction = light.direction;
            interval.y = light.distance;
            weight = lit;
            faint = WALK_FAINT * spectrum_max(lit);
        }
        if (spectrum_max(weight) <= 0.0 || !is_met) {
            if (is_shadow && !is_met) sums.light += weight;
            if (path < 0 && path >= -passes) sums.passed += weight;
            weight = is_shadow ? behind : spectrum(0.0);
            behind = spectrum(0.0);
            direction = ahead;
            interval = vec2(0.0, FAR_AWAY);
            is_shadow = false;
            faint = 0.0;
            if (spectrum_max(weight) <= 0.0) {
                ++path;
                order = 0;
                WalkRay ray = walk_start(path);
                origin = ray.origin;
                direction = ray.direction;
                interval = ray.interval;
                weight = spectrum(1.0);
            }
        }
        spans = media_spans(origin, direction);
        vec2 stretch = media_interval(spans);
        at = max(stretch.x, interval.x);
        end = min(stretch.y, interval.y);
        least = walk_least(end - at);
    }
    if (path < count) march_was_cut = true;
    return sums;
}
