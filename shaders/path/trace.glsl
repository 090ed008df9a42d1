// Follows a ray and all that surfaces send on, one at a time.
void path_trace(PathRay ray)
{
    for (int turn = 0; turn < MARCH_LIMIT; ++turn) {
        path_follow(ray);
        if (!path_take(ray)) return;
    }
    march_was_cut = true;
}
