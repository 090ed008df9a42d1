// A march that is done in one pass: it has nothing to keep.
const int MARCH_ITERATIONS = MARCH_LIMIT;

vec2 march_resume(vec2 begin, float end, inout Gathered gathered)
{
    return begin;
}

void march_keep(vec2 position, bool is_end, Gathered gathered)
{
}
