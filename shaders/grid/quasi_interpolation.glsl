// Prepares samples at a grid's corners so that trilinear interpolation between them is as near to the function as
// possible on the average, not at the corners: minus a twelfth of the second differences, the mean by which a chord is
// off its curve. Errors then have no sign, and cancel along rays. Condat, Blu and Unser, Beyond Interpolation: Optimal
// Reconstruction by Quasi-Interpolation, ICIP 2005.

// `at` has neighbours on all sides.
float grid_quasi_interpolation(sampler3D samples, ivec3 at)
{
    float middle = texelFetch(samples, at, 0).r;
    float sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        ivec3 next = ivec3(0);
        next[axis] = 1;
        sum += texelFetch(samples, at - next, 0).r + texelFetch(samples, at + next, 0).r - 2.0 * middle;
    }
    return middle - sum / 12.0;
}
