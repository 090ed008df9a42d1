// What the picture sees of a node: the share of a pixel that light scattered about it would cover, in front of which
// nothing has covered it yet. Walks go where they count: a cloud's inside and its far side show little.
const int SEEN_SIDE = 3;    // lines through the cells about a node, squared
const int SEEN_BEFORE = 16; // segments of each up to these cells,
const int SEEN_WITHIN = 6;  // and in them

// True when light is looked up between the node and its neighbours, `cell` apart: some medium is there. Half cells are
// looked at, which miss no cell of a majorant that is larger.
bool scatter_grid_is_needed(vec3 node, vec3 cell)
{
    const vec3 AHEAD = vec3(1.0, 0.0, 0.0);
    for (int i = 0; i < 125; ++i) {
        vec3 place = node + 0.5 * cell * vec3(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);
        MediaSpans spans = media_spans(place, AHEAD);
        vec2 interval = media_interval(spans);
        float edge = interval.y;
        if (interval.x <= 0.0 && interval.y > 0.0 &&
            (!SCATTER_GRID_SKIPS || media_rate(spans, media_ray(place, AHEAD), 0.0, 0.0, edge) > 0.0))
            return true;
    }
    return false;
}

float scatter_seen_depth(MediaSpans spans, vec3 direction, float at)
{
    MediaField field = media_field(spans, camera_position + at * direction, direction, at);
    return field.distance >= 0.0 ? 0.0 : spectrum_mean(media_extinction(field));
}

// Along one line of sight, that passes the node's cells at `apart`; they reach `cell` to both sides.
float scatter_seen_along(vec3 direction, float apart, float cell)
{
    MediaSpans spans = media_spans(camera_position, direction);
    vec2 interval = media_interval(spans);
    float begin = max(interval.x, 0.0), end = min(interval.y, apart + cell);
    if (begin >= end) return 0.0;
    float near = clamp(apart - cell, begin, end), depth = 0.0, seen = 0.0;
    float step = (near - begin) / float(SEEN_BEFORE);
    for (int i = 0; i < SEEN_BEFORE && step > 0.0; ++i)
        depth += step * scatter_seen_depth(spans, direction, begin + (float(i) + 0.5) * step);
    step = (end - near) / float(SEEN_WITHIN);
    for (int i = 0; i < SEEN_WITHIN; ++i) {
        float at = near + (float(i) + 0.5) * step;
        float within = step * scatter_seen_depth(spans, direction, at);
        seen += max(1.0 - abs(at - apart) / cell, 0.0) * exp(-depth) * (1.0 - exp(-within));
        depth += within;
    }
    return seen;
}

float scatter_seen(vec3 node, float cell)
{
    vec3 away = node - camera_position;
    vec3 axis = length(away) > 0.0 ? normalize(away) : vec3(0.0, 0.0, 1.0);
    float seen = 0.0;
    for (int i = 0; i < SEEN_SIDE * SEEN_SIDE; ++i) {
        float square = (float(i) + 0.5) / float(SEEN_SIDE * SEEN_SIDE);
        // Even in a disk, by the golden angle; scatter_turn(axis, 1, .) is at a right angle.
        vec3 target = away + sqrt(square) * cell * scatter_turn(axis, 1.0, fract(0.381966011 * float(i)));
        float apart = length(target);
        if (apart > 0.0) seen += scatter_seen_along(target / apart, apart, cell);
    }
    return seen / float(SEEN_SIDE * SEEN_SIDE);
}

// Below 0 for nodes whose light nothing looks up.
float scatter_seen_of(vec3 node, vec3 cell)
{
    if (!scatter_grid_is_needed(node, cell)) return -1.0;
    float seen = scatter_seen(node, max(cell.x, max(cell.y, cell.z)));
    atomicMax(cache_sums[0], floatBitsToUint(seen)); // positive floats are ordered as their bits are
    return seen;
}
