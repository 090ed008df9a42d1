// Waiting rays. The next one waits by itself, others on a stack, last in first out, so that each reflection or
// refraction along a path leaves at most one behind.
struct PathParked {
    vec4 origin_travelled;
    vec3 direction;
    Spectrum throughput;
    uint left;
    uint marks; // 16 bits of `inside`, one of `is_direct`, then the depth
};

PathRay path_next;
bool path_has_next = false;
PathParked path_parked[PATH_ROOM];
int path_parked_count = 0;

void path_wait(PathRay ray)
{
    if (!path_has_next) {
        path_next = ray;
        path_has_next = true;
        return;
    }
    uint marks = ray.inside | (ray.is_direct ? 65536u : 0u) | (uint(ray.depth) << 17u);
    path_parked[path_parked_count] =
        PathParked(vec4(ray.origin, ray.travelled), ray.direction, ray.throughput, ray.left, marks);
    ++path_parked_count;
}

bool path_take(inout PathRay ray)
{
    bool had_next = path_has_next;
    path_has_next = false;
    if (had_next) {
        ray = path_next;
        return true;
    }
    if (path_parked_count == 0) return false;
    --path_parked_count;
    PathParked parked = path_parked[path_parked_count];
    ray = PathRay(parked.origin_travelled.xyz, parked.direction, parked.throughput, parked.origin_travelled.w,
                  int(parked.marks >> 17u), parked.marks & 65535u, parked.left, (parked.marks & 65536u) != 0u);
    return true;
}
