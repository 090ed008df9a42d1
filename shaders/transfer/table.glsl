// A transfer function over a segment along which the value is linear: mean extinction and light between the values of
// its two ends, as a difference of running integrals. After Rottger, Kraus and Ertl, Hardware-Accelerated Volume and
// Isosurface Rendering Based on Cell-Projection, IEEE Visualization 2000.

// A value's position among the table's nodes, its slope, the integral up to there, and the mean of its cell.
struct TransferEnd {
    float position, slope; // of the segment that ends there, per metre
    vec4 sum, cell;
};

// The first and the last cell extend without end.
TransferEnd transfer_end(sampler2D table, float position)
{
    float node = clamp(floor(position), 0.0, float(textureSize(table, 0).x - 2));
    vec4 low = texelFetch(table, ivec2(int(node), 0), 0);
    vec4 cell = texelFetch(table, ivec2(int(node) + 1, 0), 0) - low;
    return TransferEnd(position, 0.0, low + (position - node) * cell, cell);
}

// Values need not be linear: the change of their slope to this segment says how far their mean is off the line, `bend`
// times the change. Between ends less than a cell apart a difference would lose its digits.
vec4 transfer_mean(TransferEnd from, TransferEnd to, float bend)
{
    float change = to.position - from.position;
    vec4 beside = bend * (to.slope - from.slope) * (to.cell - from.cell);
    vec4 far = max((to.sum - from.sum - beside) / change, vec4(0.0));
    return abs(change) < 1.0 ? 0.5 * (from.cell + to.cell) : far;
}
