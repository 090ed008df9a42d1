// The pixel that an invocation draws: its own place in the target, or one of a list; and what it shows.
// Holds x and y of the listed pixel that is drawn at each place. An image takes none of the texture units, which scenes
// may need.
layout(rg16ui, binding = 3) readonly uniform uimage2D pixel_list;
uniform bool pixel_is_listed;

// Differs between pixels that show different things: what their rays meet, in order. The hash is
// FNV-1a: Fowler, Noll and Vo, 1991.
uint pixel_signature = 2166136261u;

void pixel_sign(uint met)
{
    pixel_signature = (pixel_signature ^ met) * 16777619u;
}

// Whether a ray of the pixel met extinction. It is the lowest bit of what the lattice gets.
bool pixel_is_dimmed = false;

uint pixel_shown()
{
    return pixel_signature << 1 | uint(pixel_is_dimmed);
}

uvec2 pixel_drawn()
{
    ivec2 place = ivec2(gl_FragCoord.xy);

    return pixel_is_listed ? imageLoad(pixel_list, place).xy : uvec2(place);
}
