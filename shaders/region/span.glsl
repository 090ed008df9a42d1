// A stretch of a ray by its distances of entry (x) and exit (y); x >= y where it is missed.
const vec2 SPAN_MISSED = vec2(FAR_AWAY, -FAR_AWAY);
const vec2 SPAN_EVERYWHERE = vec2(-FAR_AWAY, FAR_AWAY);

bool span_has(vec2 span, float at)
{
    return at >= span.x && at < span.y;
}

vec2 span_meet(vec2 a, vec2 b)
{
    vec2 both = vec2(max(a.x, b.x), min(a.y, b.y));
    return both.x < both.y ? both : SPAN_MISSED;
}

// Returns the span from the first entry to the last exit.
vec2 span_join(vec2 a, vec2 b)
{
    return vec2(min(a.x, b.x), max(a.y, b.y));
}

// Returns how far it is still empty from `at`, which is not in the span.
float span_ahead(vec2 span, float at)
{
    return at < span.x ? span.x - at : FAR_AWAY;
}

// Returns the nearest of `end` and those of the span's ends that lie beyond `at`.
float span_next_edge(vec2 span, float at, float end)
{
    if (span.x > at) end = min(end, span.x);
    if (span.y > at) end = min(end, span.y);
    return end;
}

// Returns the span's length between 0 and `end`.
float span_length(vec2 span, float end)
{
    return max(min(span.y, end) - max(span.x, 0.0), 0.0);
}
