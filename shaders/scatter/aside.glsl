// Second paths towards where lamps' light comes from, for media that scatter in narrow lobes: a vertex sees a lamp
// brightly only if its path flies along the lamp's light, into which a narrow lobe seldom turns. So some vertices send
// a path whose first direction is drawn by the lobe about a lamp, and which looks for lamps alone; at further vertices
// it goes on as often as directions are remembered. What is seen counts by the balance heuristic over all ways to come
// there: Veach and Guibas, SIGGRAPH 1995.

// Of media that scatter backward, a lobe about the lamp begins away from it: the next vertex turns the light back.
const float WALK_ASIDE_LEAST = 0.1;    // the least chance, where the lamp's light comes from far aside
const float WALK_ASIDE_FALL = 2.0;     // mean free paths, beyond those that second paths go, in which chances fall
const float WALK_ASIDE_DEEPEST = 16.0; // and there are none

// The chance that a vertex sends one, of whose lamp `passed` of the light arrives and which scatters the share `phase`
// a steradian to where it begins.
float walk_aside_chance(float passed, float phase, float goes_on)
{
    float beyond = -log(max(passed, 1e-30)) - 1.0 / max(1.0 - goes_on, 0.01);
    if (beyond > WALK_ASIDE_DEEPEST) return 0.0;
    return exp(-max(beyond, 0.0) / WALK_ASIDE_FALL) * clamp(phase / INV_4PI, WALK_ASIDE_LEAST, 1.0);
}
