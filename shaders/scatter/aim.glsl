// Directions towards lamps, in thin media that scatter in narrow lobes. Light of later orders comes by paths that turn
// towards a lamp little by little, which few do by chance: some directions are drawn about the lamp instead. All count
// by the density of both ways together (the balance heuristic: Veach and Guibas, SIGGRAPH 1995).

// The share of a path's first directions, halved at each vertex, so that no weight grows beyond what the first ones
// repay.
const float WALK_AIM_FIRST = 0.25;
const float WALK_AIM_G = 0.7; // of the lobe about the lamp, by Henyey and Greenstein

// The share of directions that are drawn about a lamp, of whose light `passed` reaches the vertex.
float walk_aim_share(int order, float passed)
{
    return WALK_AIM_FIRST * exp2(float(1 - order)) * clamp(passed, 0.0, 1.0);
}

vec3 walk_aim_draw(vec3 toward)
{
    return scatter_turn(toward, scatter_henyey_greenstein(WALK_AIM_G, walk_random()), walk_random());
}

// Per steradian.
float walk_aim_density(vec3 toward, vec3 direction)
{
    return phase_henyey_greenstein(PhaseHenyeyGreenstein(WALK_AIM_G), toward, direction);
}
