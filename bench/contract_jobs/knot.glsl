// Smoke along a trefoil, without a lipschitz; it is broken by waves that run along the tube.
float density(vec3 p, float t)
{
    float nearest = 1e9, along = 0.0;
    vec3 from = vec3(1.0, 0.0, 0.0);

    for (int i = 1; i <= 36; i++) {
        float angle = 6.2831853 * float(i) / 36.0, radius = 0.72 + 0.28 * cos(3.0 * angle);
        vec3 to = vec3(radius * cos(2.0 * angle), 0.3 * sin(3.0 * angle), radius * sin(2.0 * angle)), edge = to - from;
        float at = clamp(dot(p - from, edge) / dot(edge, edge), 0.0, 1.0), apart = length(p - from - at * edge);

        if (apart < nearest) { nearest = apart; along = angle; }
        from = to;
    }
    vec3 waves = sin(17.0 * p + 2.0 * sin(11.0 * p.zxy + vec3(0.0, -t, t)));
    float holes = 0.5 + 0.25 * (waves.x + waves.y * waves.z) + 0.2 * sin(3.0 * along - 3.0 * t);
    return max(0.17 - nearest, 0.0) * 6.0 * smoothstep(0.2, 0.7, holes);
}
