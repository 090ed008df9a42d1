// Rays of low throughput or large depth are cut, and counted.
// x: throughput that was cut, y: rays that were cut, z: rays that were followed (the camera's is one), w: throughput
// that only the depth cut.
vec4 path_counts = vec4(0.0, 0.0, 1.0, 0.0);

void path_send(PathRay ray)
{
    float most = spectrum_max(ray.throughput);
    if (most <= 0.0) return;
    bool is_dim = most < quality_min_throughput;
    if (is_dim || ray.depth > int(quality_max_depth)) {
        float throughput = spectrum_mean(ray.throughput);
        path_counts += vec4(throughput, 1.0, 0.0, is_dim ? 0.0 : throughput);
        return;
    }
    path_counts.z += 1.0;
    path_wait(ray);
}
