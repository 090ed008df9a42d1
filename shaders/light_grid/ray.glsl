// A ray of light with a row of a grid's nodes, evenly from its start to its end.
struct LightGridRay { vec3 start, direction; float length; };
