// A point where light is gathered, and what it stands for.
struct Placed { float at, weight; };
