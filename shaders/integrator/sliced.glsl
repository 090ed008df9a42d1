// A march that resumes in the next slice of the frame where it stopped in this one: it keeps its state at the last
// position from which it can resume. Nothing is kept once the driver has run out of iterations, since results after
// that may be anything.
const int MARCH_ITERATIONS = 20000; // of the driver's; the rest is for gathering light at the last position

Gathered slice_gathered;
vec2 slice_position;   // where it resumes, as the integrator counts
uint slice_random;  // state of the random numbers there
bool slice_is_begun;
float slice_start;  // the position where this slice began
int slice_kept = 0; // positions kept in this slice
bool slice_is_over = false; // and its result is complete

// `end` is the position where the march is done.
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

// True where light was gathered between two kept positions.
bool slice_has_moved()
{
    return slice_kept > 1 || slice_position.x != slice_start;
}
