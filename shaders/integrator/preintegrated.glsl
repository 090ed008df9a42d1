// Marches in segments of `step`; the last one before an edge of a medium's span ends exactly there. Media with a
// transfer function follow from the values at a segment's two ends, of which the last is the next segment's first.
// Other media are those of its middle. Engel, Kraus and Ertl, High-Quality Pre-Integrated Volume Rendering Using
// Hardware-Accelerated Pixel Shading, Graphics Hardware 2001.
struct IntegratorPreintegrated { float step; };

// A segment counts as homogeneous. One of more optical depth than this is several, between which values are linear.
const float PREINTEGRATED_DEPTH = 1.0;
const float PREINTEGRATED_PIECES = 16.0;
// Rounding may leave a ray just before the face that it should pass: a ray moves at least this share of a step.
const float PREINTEGRATED_LEAST = 1.0 / 64.0;

// Distances are counted from where the media begin, so that a far camera does not cost digits.
void integrator_preintegrated(IntegratorPreintegrated method, vec3 origin, vec3 direction, vec2 interval,
                              MediaSpans spans, inout Gathered gathered)
{
    vec3 entry = origin + interval.x * direction;
    MediaSpans ahead = media_spans_from(spans, interval.x);
    float end = interval.y - interval.x;
    float at = 0.0;
    float clear_end = MEDIA_CLEAR_END; // up to there are no other media
    bool is_known = false;             // the values at `at` are known
    float before = 0.0;                // length of the segment that ends there; 0 for none
    MediaEnds begin = media_ends(entry);
    for (int iteration = 0; iteration < MARCH_LIMIT && at < end; ++iteration) {
        float length = 0.0;
        float bend = 0.0;
        MediaEnds next;
        MediaField field;
        // Where media are lit, rays that share a SIMD unit wait here for one another, to march to the lights together.
        for (; iteration < MARCH_LIMIT && at < end; ++iteration) {
            for (; iteration < MARCH_LIMIT && at < end; ++iteration) {
                float clear = min(media_clear(ahead, entry + at * direction, direction, at), clear_end - at);
                if (clear <= 0.0) break;
                at += max(clear, PREINTEGRATED_LEAST * method.step);
                is_known = false;
            }
            if (at >= end) break;
            // After a gap the values come first, in an iteration of their own.
            length = is_known ? min(method.step, media_next_edge(ahead, at, end) - at) : 0.0;
            float middle = at + 0.5 * length;
            field = media_field(ahead, entry + middle * direction, direction, middle);
            clear_end = max(clear_end, middle + field.distance);
            next = media_ends(entry + (at + length) * direction);
            media_set_slopes(next, begin, max(length, 1e-30));
            // Values are a parabola whose second derivative is the slope's change over the distance of the middles. Its
            // mean differs from its chord by a twelfth of that times the square of the length.
            bend = before > 0.0 ? length * length / (6.0 * (before + length)) : 0.0;
            media_set_means(field, begin, next, bend);
            before = length;
            is_known = true;
            if (!MEDIA_ARE_LIT || (length > 0.0 && (field.distance < 0.0 || media_depth(field) > 0.0))) break;
            begin = next;
            at += length;
        }
        if (at >= end) break;
        float pieces = clamp(ceil(media_depth(field) * length * (1.0 / PREINTEGRATED_DEPTH)), 1.0,
                             MEDIA_ARE_LIT ? 1.0 : PREINTEGRATED_PIECES);
        float piece = length / pieces;
        MediaEnds from = begin;
        for (float k = 1.0; k < pieces; ++k) {
            MediaEnds to = media_ends_between(begin, next, k / pieces);
            float start = at + (k - 1.0) * piece;
            media_set_means(field, from, to, 0.0);
            gather(gathered, field, entry + start * direction, direction, interval.x + start, piece);
            from = to;
            bend = 0.0;
        }
        media_set_means(field, from, next, bend);
        gather(gathered, field, entry + (at + 0.5 * length) * direction, direction,
               interval.x + at + length - piece, piece);
        at += length; // as one sum: a piece may be too small to change it
        begin = next;
        if (gathered_is_over(gathered)) break;
    }
    if (at < end && !gathered_is_over(gathered)) march_was_cut = true;
}
