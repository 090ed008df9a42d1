// Waiting rays where no surface of the scene sends two rays on: at most one waits.
PathRay path_waiting;
bool path_is_waiting = false;

void path_wait(PathRay ray)
{
    path_waiting = ray;
    path_is_waiting = true;
}

bool path_take(inout PathRay ray)
{
    if (!path_is_waiting) return false;
    ray = path_waiting;
    path_is_waiting = false;
    return true;
}
