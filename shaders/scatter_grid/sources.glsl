// Where particles of light begin, so that they meet the cells: light of all directions and places that does is drawn.

// A particle's beginning. The measure is the inverse of its density, per steradian and square metre of what the light
// is: of a lamp's intensity per steradian, of a sun's irradiance per square metre, of a dome's radiance both.
struct ScatterSource {
    vec3 position, direction; // of travel
    float measure;
};

// The cells about the nodes: the box, and half a cell around it.
vec3 scatter_cell_size()
{
    return scatter_grid_size / (scatter_grid_nodes - 1.0);
}

vec3 scatter_cells_low()
{
    return scatter_grid_low - 0.5 * scatter_cell_size();
}

vec3 scatter_cells_size()
{
    return scatter_grid_size + scatter_cell_size();
}

vec3 scatter_cells_middle()
{
    return scatter_grid_low + 0.5 * scatter_grid_size;
}

// The area that the cells show to parallel light.
float scatter_cells_silhouette(vec3 direction)
{
    vec3 size = scatter_cells_size();
    return dot(abs(direction), size.yzx * size.zxy);
}

// The mean over all directions: a fourth of a convex body's surface (Cauchy).
float scatter_cells_silhouette_mean()
{
    vec3 size = scatter_cells_size();
    return 0.5 * dot(size.yzx, size.zxy);
}

// Parallel light enters their box by up to three of its faces, each point of the silhouette as likely.
ScatterSource scatter_source_parallel(vec3 direction, vec2 share)
{
    vec3 size = scatter_cells_size();
    vec3 faces = abs(direction) * size.yzx * size.zxy;
    float area = faces.x + faces.y + faces.z;
    float place = share.x * area;
    int axis = 0;
    if (place >= faces.x) {
        place -= faces.x;
        axis = 1;
        if (place >= faces.y) {
            place -= faces.y;
            axis = 2;
        }
    }
    vec3 at = vec3(0.0);
    at[axis] = direction[axis] > 0.0 ? 0.0 : 1.0;
    at[(axis + 1) % 3] = clamp(place / max(faces[axis], 1e-30), 0.0, 1.0);
    at[(axis + 2) % 3] = share.y;
    return ScatterSource(scatter_cells_low() + at * size, direction, area);
}

// 1 less the cosine of the cone that holds them, seen from a lamp of some radius; 2, the whole sphere, next to it.
float scatter_source_cap(vec3 position, float radius)
{
    float apart = distance(scatter_cells_middle(), position);
    float reach = 0.5 * length(scatter_cells_size()) + radius;
    float sine_square = reach * reach / max(apart * apart, 1e-30);
    return sine_square < 1.0 ? sine_square / (1.0 + sqrt(1.0 - sine_square)) : 2.0;
}

// Even in a cone. A sphere seen from afar is a disk: its light begins on the sphere, above an even point of the disk.
ScatterSource scatter_source_cone(vec3 position, float radius, vec3 axis, float cap, vec2 share, vec2 on_disk)
{
    vec3 direction = scatter_turn(axis, cap * share.x, share.y);
    float square = on_disk.x;
    vec3 aside = scatter_turn(direction, 1.0, on_disk.y); // at a right angle
    vec3 beside = radius * (sqrt(square) * aside + sqrt(max(1.0 - square, 0.0)) * direction);
    return ScatterSource(position + beside, direction, 6.28318530717958648 * cap);
}
