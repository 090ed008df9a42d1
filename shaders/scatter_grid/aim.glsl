// Where a walk goes on: by the phase function about its direction, or about that to a lamp. Both have a peak, in which
// the light of the next scattering may lie. What is drawn is weighted by the density of both kinds together (Veach and
// Guibas, Optimally combining sampling techniques, SIGGRAPH 1995).
const float SCATTER_AIMED = 0.1; // of all draws, those about the direction to a lamp

// Takes what it needs from `share`.
vec3 scatter_aim_about(vec3 point, vec3 direction, inout vec2 share)
{
    if (share.x >= SCATTER_AIMED) {
        share.x = (share.x - SCATTER_AIMED) / (1.0 - SCATTER_AIMED);
        return direction;
    }
    share.x *= float(WALK_LAMPS) / SCATTER_AIMED;
    int lamp = min(int(share.x), WALK_LAMPS - 1);
    share.x -= float(lamp);
    return walk_lamp(lamp, point);
}

// `lit` is the sum of the phase function about the directions to all lamps.
float scatter_aim_weight(float phase, float lit)
{
    return phase / ((1.0 - SCATTER_AIMED) * phase + SCATTER_AIMED / float(WALK_LAMPS) * lit);
}
