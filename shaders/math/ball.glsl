// The ball, centred on the world's origin, that holds all media: nothing is outside.
struct Ball { float radius; };

// Distances along the ray where it enters and leaves; entry > exit where it misses. The nearest point of the ray is taken
// first, so that a far camera keeps its digits.
vec2 ball_interval(Ball ball, vec3 origin, vec3 direction)
{
    float along = -dot(origin, direction);
    vec3 nearest = origin + along * direction;
    float square = ball.radius * ball.radius - dot(nearest, nearest);
    if (square <= 0.0) return vec2(FAR_AWAY, -FAR_AWAY);
    float half_chord = sqrt(square);
    return vec2(along - half_chord, along + half_chord);
}

// How far a point in the ball is from its surface in a direction; 0 for a point outside that looks away.
float ball_exit(Ball ball, vec3 point, vec3 direction)
{
    float along = -dot(point, direction);
    vec3 nearest = point + along * direction;
    return max(along + sqrt(max(ball.radius * ball.radius - dot(nearest, nearest), 0.0)), 0.0);
}
