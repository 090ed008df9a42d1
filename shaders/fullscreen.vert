#version 450 core
// One triangle that covers the viewport; for a list, a point for each of its squares: worker/render/pixel_layout.h.
uniform bool pixel_is_listed;
uniform ivec3 list_squares; // columns, rows, and the side of a square, px

const int LIST_PITCH = 64; // px

void main()
{
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
    if (pixel_is_listed) {
        vec2 corner = vec2(gl_VertexID % list_squares.x, gl_VertexID / list_squares.x);
        vec2 middle = corner + 0.5 * float(list_squares.z) / float(LIST_PITCH);

        gl_Position.xy = 2.0 * middle / vec2(list_squares.xy) - 1.0;
        gl_PointSize = float(list_squares.z);
    }
}
