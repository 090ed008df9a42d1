// Follows a ray and all rays that surfaces send on, one at a time.
void path_trace(PathRay ray)
{
    for (int iteration = 0; iteration < MARCH_LIMIT; ++iteration) {
        path_follow(ray);
        if (!path_take(ray)) return;
    }
    march_was_cut = true;
}
