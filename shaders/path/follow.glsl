// Follows one ray through the media before the next boundary, which then answers it.
void path_follow(PathRay ray)
{
    uint left = surface_left(ray.left, ray.origin, ray.direction);
    SurfaceHit hit = surface_visible(shape_spans(ray.origin, ray.direction), 0.0, ray.inside, left);
    pixel_sign(hit.at < FAR_AWAY ? hit.shapes : 0u);
    path_gather(ray, hit.at);
    if (hit.at < FAR_AWAY)
        path_answer(ray, hit);
    else
        path_escape(ray);
}
