// A march that is done in one go: it has nothing to keep.
const int MARCH_TURNS = MARCH_LIMIT;

vec2 march_resume(vec2 begin, float end, inout Gathered gathered)
{
    return begin;
}

void march_keep(vec2 place, bool is_end, Gathered gathered)
{
}
