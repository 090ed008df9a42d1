// Light of a lamp in media or next to them. Its 1 / r^2 has an infinite variance where paths come near it by chance, so
// a part of the light that is scattered near it is left to vertices of their own, which are drawn together with the
// direction to them: Georgiev, Krivanek, Hachisuka, Nowrouzezahrai and Jarosz, ACM Transactions on Graphics 32(6),
// 2013.

// The reach around a lamp in a medium: some mean free paths of a majorant there, and a fraction of the medium's extent.
float walk_near_reach(float extent, float rate)
{
    return min(extent, 8.0 / max(rate, 1e-30));
}

// The part of what is scattered at `square`, the distance to the lamp squared, that belongs to these vertices: all of
// it at the lamp, nothing beyond its reach, and smooth between.
float walk_near_part(float square, float reach)
{
    float far = clamp(square / (reach * reach), 0.0, 1.0);
    return (1.0 - far) * (1.0 - far);
}

// A drawn vertex, and the inverse of its density.
struct WalkNear {
    vec3 direction;
    float distance, weight;
    int lamp; // near which it is
};

// From this g on, forward or backward, following lobes repays its time.
const float WALK_NEAR_NARROW = 0.65;

float walk_near_followed(float g)
{
    return abs(g) < WALK_NEAR_NARROW ? 0.0 : clamp(g, -0.999, 0.999);
}

// The share of Cauchy's distribution on a circle that turns by less.
float walk_near_turned(float g, float turn)
{
    return 0.63661977236758134 * atan((1.0 + g) * sin(0.5 * turn), (1.0 - g) * cos(0.5 * turn));
}

// A line that passes a point: the distance to what is next to it, metres beside it, and the angles within which places
// are drawn, as the point sees them from what is next to it. Light that comes by the line and goes on to the point, or
// the other way round, turns by such an angle and a right one. Every other draw follows a lobe of `g`, if that is not
// 0.
struct WalkNearLine { float foot, beside, first, span, g; };

WalkNearLine walk_near_line(float foot, float beside, vec2 ends, float g)
{
    float first = atan(ends.x - foot, beside);
    return WalkNearLine(foot, beside, first, max(atan(ends.y - foot, beside) - first, 0.0), g);
}

// The inverse of the density of an angle.
float walk_near_inverse(WalkNearLine line, float angle)
{
    float g = line.g;
    if (g == 0.0) return line.span;
    float turn = 1.57079632679489662 + line.first;
    float part = walk_near_turned(g, turn + line.span) - walk_near_turned(g, turn);
    float off = sin(0.5 * (1.57079632679489662 + angle));
    float sharp = (1.0 - g) * (1.0 - g) + 4.0 * g * off * off;
    return 2.0 / (1.0 / max(line.span, 1e-30) + (1.0 - g * g) / max(3.14159265358979324 * sharp * part, 1e-30));
}

float walk_near_angle(WalkNearLine line)
{
    float u = walk_random();
    float even = line.first + u * line.span;
    float g = line.g;
    if (g == 0.0 || walk_random() < 0.5) return even;
    float turn = 1.57079632679489662 + line.first;
    u = 1.57079632679489662 * mix(walk_near_turned(g, turn), walk_near_turned(g, turn + line.span), u);
    float angle = 2.0 * atan((1.0 - g) * sin(u), (1.0 + g) * cos(u)) - 1.57079632679489662;
    return clamp(angle, line.first, line.first + line.span);
}

// Where a ray is within a lamp's reach, as the lamp sees it: Kulla and Fajardo, Computer Graphics Forum 31(4), 2012.
// `toward` leads from its origin to the lamp.
WalkNearLine walk_near_line_of(vec3 toward, vec3 direction, vec2 interval, float reach, float g)
{
    float along = dot(toward, direction);
    vec3 off = toward - along * direction;
    float beside = max(length(off), 1e-6); // a lamp on the ray counts as a micrometre beside it
    float half_way = sqrt(max(reach * reach - beside * beside, 0.0));
    vec2 ends = vec2(max(interval.x, along - half_way), min(interval.y, along + half_way));
    return walk_near_line(along, beside, ends.x < ends.y ? ends : vec2(along), g);
}

// The inverse of the density of what is drawn on such a line, per metre; 0 where nothing is drawn.
float walk_near_on_inverse(WalkNearLine line, float distance)
{
    float rise = distance - line.foot;
    float angle = atan(rise, line.beside);
    if (angle < line.first - 1e-4 || angle > line.first + line.span + 1e-4 || line.span <= 0.0) return 0.0;
    return walk_near_inverse(line, angle) * (line.beside * line.beside + rise * rise) / line.beside;
}

// The weight is per metre.
WalkNear walk_near_on(WalkNearLine line, vec3 direction)
{
    if (line.span <= 0.0) return WalkNear(direction, 0.0, 0.0, 0);
    float distance = line.foot + line.beside * tan(walk_near_angle(line));
    return WalkNear(direction, distance, walk_near_on_inverse(line, distance), 0);
}

const float WALK_NEAR_BESIDE = 1.1; // half-angles of a spot: a vertex that is farther off its axis is beside the cone

// The half-angle about the way from the lamp to the vertex before within which directions are drawn evenly in their
// angle; 0: they are even in the cone of half-angle `outer` about `axis`, beside which the vertex lies.
float walk_near_widest(vec3 toward, vec3 axis, float outer)
{
    float off = arc(length(cross(axis, toward)), -dot(axis, toward));
    return off <= WALK_NEAR_BESIDE * outer ? min(off + outer, 3.14159265358979324) : 0.0;
}

// The line from the lamp along `way`, as the vertex before sees it.
WalkNearLine walk_near_line_from(vec3 toward, vec3 way, float reach, float g)
{
    float beside = max(length(cross(toward, way)), 1e-6 * length(toward) + 1e-12);
    return walk_near_line(-dot(toward, way), beside, vec2(0.0, reach), g);
}

// The inverse of the density of a direction from the lamp at an angle to the way to the vertex before, per steradian.
float walk_near_way_inverse(float widest, float angle, float outer)
{
    float sine = sin(0.5 * outer);
    return 6.28318530717958648 * (widest > 0.0 ? widest * sin(max(angle, 1e-6)) : 2.0 * sine * sine);
}

// A direction from the lamp, then a place on it in the angle that the vertex before sees: the density is in proportion
// to the inverse squares of both distances, so that what is left of them is finite. A point has an `outer` of pi. The
// weight is per metre and steradian as seen from the vertex before.
WalkNear walk_near_from(vec3 toward, float reach, vec3 axis, float outer, float g)
{
    float widest = walk_near_widest(toward, axis, outer);
    float angle = widest > 0.0 ? max(widest * walk_random(), 1e-6) : outer;
    float sine = sin(0.5 * angle);
    float less = 2.0 * sine * sine * (widest > 0.0 ? 1.0 : walk_random());
    vec3 way = scatter_turn(widest > 0.0 ? -normalize(toward) : axis, less, walk_random());
    WalkNearLine line = walk_near_line_from(toward, way, reach, g);
    float seen = walk_near_angle(line);
    float away = clamp(line.foot + line.beside * tan(seen), 0.0, reach);
    vec3 path = toward + away * way;
    float distance = max(length(path), 1e-12);
    float weight = walk_near_way_inverse(widest, angle, outer) * away * away * walk_near_inverse(line, seen);
    return WalkNear(path / distance, distance, weight / line.beside, 0);
}

// The weight of a place that was drawn otherwise; 0 where it would not be drawn so.
float walk_near_from_inverse(WalkNear near, vec3 toward, float reach, vec3 axis, float outer, float g)
{
    vec3 from = near.distance * near.direction - toward;
    float away = length(from);
    if (away <= 0.0 || away > 1.0001 * reach) return 0.0;
    vec3 way = from / away;
    float widest = walk_near_widest(toward, axis, outer);
    float angle = arc(length(cross(way, toward)), -dot(way, toward));
    WalkNearLine line = walk_near_line_from(toward, way, reach, g);
    float seen = atan(away - line.foot, line.beside);
    return walk_near_way_inverse(widest, angle, outer) * away * away * walk_near_inverse(line, seen) / line.beside;
}

// Of one place that may have been drawn in two ways, each as likely, the inverse of the density: the balance heuristic
// (Veach and Guibas, SIGGRAPH 1995). `phase` is the density of its direction in the second.
float walk_near_either(float from, float on, float phase)
{
    return 2.0 / (1.0 / from + (on > 0.0 ? phase / on : 0.0));
}
