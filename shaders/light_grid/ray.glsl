// A way of light along which a light's grid has a row of nodes, from its start on, evenly to its end.
struct LightGridRay { vec3 start, direction; float length; };
