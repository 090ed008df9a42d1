// Second paths towards where lamps' light comes from, for media that scatter in narrow lobes: a vertex sees a lamp
// brightly only if its path flies along the lamp's light, into which a narrow lobe seldom turns. So some vertices send
// a path whose first direction is drawn by the lobe about a lamp, and which looks for lamps alone; at further vertices
// it goes on as often as directions are remembered. What is seen counts by the balance heuristic over all ways to come
// there: Veach and Guibas, SIGGRAPH 1995.

const bool WALK_SENDS = true; // as no_aside.glsl has it

// Of media that scatter backward, a lobe about the lamp begins away from it: the next vertex turns the light back.
const float WALK_ASIDE_LEAST = 0.1;    // the least chance, where the lamp's light comes from far aside
const float WALK_ASIDE_FALL = 2.0;     // mean free paths, beyond those that second paths go, in which chances fall
const float WALK_ASIDE_DEEPEST = 16.0; // and there are none

// The share that a vertex scatters from one direction into another, a steradian.
float walk_aside_phase(vec3 incoming, vec3 outgoing, WalkVertex vertex, Spectrum weight)
{
    return spectrum_mean(weight * walk_scattered(vertex, incoming, outgoing)) /
           max(spectrum_mean(weight * walk_scattering(vertex)), 1e-30);
}

// The chance that a vertex sends one about the direction of a lamp, of whose light `passed` arrives.
float walk_aside_chance(float passed, vec3 toward, vec3 incoming, WalkVertex vertex, Spectrum weight)
{
    float beyond = -log(max(passed, 1e-30)) - 1.0 / max(1.0 - walk_aside_goes_on(), 0.01);
    if (beyond > WALK_ASIDE_DEEPEST) return 0.0;
    float phase = walk_aside_phase(incoming, WALK_ASIDE_SIDE * toward, vertex, weight);
    return exp(-max(beyond, 0.0) / WALK_ASIDE_FALL) * clamp(phase / INV_4PI, WALK_ASIDE_LEAST, 1.0);
}

// The density of second paths in a direction, their chance included, relative to that of the path itself.
float walk_aside_density(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, vec3 outgoing)
{
    if (!walk_sends()) return 0.0;
    float sum = 0.0;
    for (int lamp = 0; lamp < WALK_LAMPS; ++lamp) {
        float passed;
        vec3 toward = walk_lamp_seen(lamp, point, passed).direction;
        float chance = walk_aside_chance(passed, toward, incoming, vertex, weight);
        if (chance > 0.0) sum += chance * walk_aside_phase(toward, outgoing, vertex, weight);
    }
    return sum / (float(WALK_LAMPS) * max(walk_aside_phase(incoming, outgoing, vertex, weight), 1e-30));
}

// Draws whether one is sent, and its direction. Returns its weight there, or 0.
Spectrum walk_aside(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, out vec3 outgoing)
{
    outgoing = incoming;
    if (!walk_sends()) return spectrum(0.0);
    float passed;
    vec3 toward = walk_lamp_seen(walk_lamp_draw(), point, passed).direction;
    if (walk_random() >= walk_aside_chance(passed, toward, incoming, vertex, weight)) return spectrum(0.0);
    walk_scatter(vertex, toward, weight, outgoing);
    return weight * walk_scattered(vertex, incoming, outgoing) /
           max(walk_aside_phase(incoming, outgoing, vertex, weight), 1e-30);
}
