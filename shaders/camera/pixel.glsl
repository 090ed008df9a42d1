// The pixel that an invocation draws: its own place in the target, or one of a list.
layout(binding = 72) uniform usampler2D pixel_list; // x and y, at the place where each is drawn
uniform bool pixel_is_listed;

uvec2 pixel_drawn()
{
    ivec2 place = ivec2(gl_FragCoord.xy);

    return pixel_is_listed ? texelFetch(pixel_list, place, 0).xy : uvec2(place);
}
