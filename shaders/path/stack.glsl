// Rays that wait while another is followed. The last one is taken first, so that each reflection or refraction on the way leaves
// one behind at most.
PathRay path_waiting[PATH_DEPTH_LIMIT + 1];
int path_waiting_count = 0;

void path_wait(PathRay ray)
{
    path_waiting[path_waiting_count] = ray;
    ++path_waiting_count;
}

bool path_take(inout PathRay ray)
{
    if (path_waiting_count == 0) return false;
    --path_waiting_count;
    ray = path_waiting[path_waiting_count];
    return true;
}
