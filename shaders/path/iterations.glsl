// True when the driver runs no more iterations of loops for this pixel: then two, of which it cannot know, are not run.
bool path_iterations_are_spent()
{
    int wanted = gl_FragCoord.x < 0.0 ? 3 : 2;
    int iterations = 0;
    while (iterations < wanted)
        ++iterations;
    return iterations < 2;
}
