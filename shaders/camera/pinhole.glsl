// A pinhole camera. The ray through image point (x, y) in pixels, y down from the top, is corner + x across + y down,
// which goes one metre forward.
struct CameraPinhole { vec3 position, corner, across, down; };

vec3 camera_pinhole_toward(CameraPinhole camera, vec2 point_px)
{
    return camera.corner + point_px.x * camera.across + point_px.y * camera.down;
}
