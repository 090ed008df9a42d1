// A march that goes on in the next slice of the frame where it had to stop in this one: what it had at the last place from
// which it can go on is kept. Nothing is kept once the driver has run out of turns, as what came then may be anything.
const int MARCH_ITERATIONS = 20000; // of the driver's; the rest is for what is gathered at the place that they lead to

Gathered slice_gathered;
vec2 slice_position;   // where it goes on, as the integrator counts
uint slice_random;  // state of the random numbers there
bool slice_is_begun;
float slice_start;  // the place where this slice began
int slice_kept = 0; // places of this slice
bool slice_is_over = false; // and nothing is lost

// `end` is the place where there is nothing left to do.
vec2 march_resume(vec2 begin, float end, inout Gathered gathered)
{
    if (slice_is_begun) {
        gathered = slice_gathered;
    } else {
        slice_gathered = gathered;
        slice_position = begin;
        slice_random = slice_random_now();
    }
    slice_start = slice_position.x;
    slice_is_over = slice_position.x >= end;
    return slice_position;
}

void march_keep(vec2 position, bool is_end, Gathered gathered)
{
    if (march_was_cut || path_iterations_are_spent()) return;
    slice_gathered = gathered;
    slice_position = position;
    slice_random = slice_random_now();
    slice_is_over = is_end;
    ++slice_kept;
}

// Between two places that were kept something was gathered.
bool slice_has_moved()
{
    return slice_kept > 1 || slice_position.x != slice_start;
}
