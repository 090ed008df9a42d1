// Rays that are not worth following are cut, and counted.
vec3 path_counts = vec3(0.0, 0.0, 1.0); // throughput that was cut, rays that were, rays that were followed: the camera's is one

void path_send(PathRay ray)
{
    float most = spectrum_max(ray.throughput);
    if (most <= 0.0) return;
    if (ray.depth > PATH_DEPTH_LIMIT || most < PATH_THROUGHPUT_LIMIT) {
        path_counts += vec3(spectrum_mean(ray.throughput), 1.0, 0.0);
        return;
    }
    path_counts.z += 1.0;
    path_wait(ray);
}
