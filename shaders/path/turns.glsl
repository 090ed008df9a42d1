// True when the driver has no more turns of loops left for this pixel: two, of which it cannot know, are not run then.
bool path_turns_are_spent()
{
    int wanted = gl_FragCoord.x < 0.0 ? 3 : 2;
    int turns = 0;
    while (turns < wanted)
        ++turns;
    return turns < 2;
}
