// Renders one frame for a test on a context of its own.
#pragma once

struct image;
struct job;

// Frame 0 on OSMesa, with depth and transmittance; a failure fails the test. The caller finishes the image.
void render_frame_zero(const struct job *job, struct image *image);
