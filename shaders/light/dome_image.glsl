// Light from an image in latitude and longitude: u = 1/2 - atan(x, z) / 2 pi to the right, v = 1/2 + asin(y) / pi up.
// It is bilinear between the middles of its texels; the outermost rows reach to the poles.
struct LightDomeImage {
    Spectrum scale;
    mat3 turn; // from the world into the image
};

const float DOME_TURN = 6.28318530717958648;

// Where the direction is in the image, in texels from its upper left corner.
vec2 light_dome_image_place(LightDomeImage light, vec3 toward, ivec2 size)
{
    vec3 own = light.turn * toward;
    float across = 0.5 - arc(own.x, own.z + 1e-30) / DOME_TURN;
    float down = 0.5 - 2.0 * arc(own.y, length(own.xz) + 1e-30) / DOME_TURN;
    return vec2(across, down) * vec2(size);
}

vec3 light_dome_image_radiance(LightDomeImage light, sampler2D image, vec3 toward)
{
    ivec2 size = textureSize(image, 0);
    vec2 at = light_dome_image_place(light, toward, size) - 0.5;
    vec2 low = floor(at);
    vec2 share = at - low;
    ivec2 first = ivec2(low);
    ivec2 second = first + 1;
    first.x += first.x < 0 ? size.x : 0;
    second.x -= second.x >= size.x ? size.x : 0;
    first.y = clamp(first.y, 0, size.y - 1);
    second.y = clamp(second.y, 0, size.y - 1);
    vec3 top_left = texelFetch(image, first, 0).rgb;
    vec3 bottom_left = texelFetch(image, ivec2(first.x, second.y), 0).rgb;
    vec3 top = top_left + share.x * (texelFetch(image, ivec2(second.x, first.y), 0).rgb - top_left);
    vec3 bottom = bottom_left + share.x * (texelFetch(image, second, 0).rgb - bottom_left);
    return light.scale * (top + share.y * (bottom - top));
}

// One of `count` texels of the table's row, by Walker's method of aliases (ACM Transactions on Mathematical Software 3,
// 1977): x of a texel is its own share of the draw, y the texel that has the remainder.
int light_dome_image_choose(sampler2D table, int row, int count, vec2 share)
{
    int chosen = min(int(share.x * float(count)), count - 1);
    vec2 entry = texelFetch(table, ivec2(chosen, row), 0).xy;
    return share.y < entry.x ? chosen : int(entry.y);
}

// A random direction, by the light that each texel brings, and even within a texel. The table is the image's
// (worker/textures/dome_table.h); `rows`, `columns` and `inside` are in [0, 1)^2.
vec3 light_dome_image_draw(LightDomeImage light, sampler2D image, sampler2D table, vec2 rows, vec2 columns, vec2 inside)
{
    ivec2 size = textureSize(image, 0);
    int row = light_dome_image_choose(table, size.y, size.y, rows);
    int column = light_dome_image_choose(table, row, size.x, columns);
    float top = sin(0.5 * DOME_TURN * (0.5 - float(row) / float(size.y)));
    float bottom = sin(0.5 * DOME_TURN * (0.5 - float(row + 1) / float(size.y)));
    float y = mix(top, bottom, inside.y);
    float angle = DOME_TURN * (0.5 - (float(column) + inside.x) / float(size.x));
    float aside = sqrt(max(1.0 - y * y, 0.0));
    return normalize(vec3(aside * sin(angle), y, aside * cos(angle)) * light.turn);
}

// The density of such directions, per steradian.
float light_dome_image_density(LightDomeImage light, sampler2D image, sampler2D table, vec3 toward)
{
    ivec2 size = textureSize(image, 0);
    ivec2 at = clamp(ivec2(light_dome_image_place(light, toward, size)), ivec2(0), size - 1);
    return texelFetch(table, at, 0).z;
}
