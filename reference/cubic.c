// SPDX-License-Identifier: Apache-2.0
#include "reference/cubic.h"

#include <math.h>
#include <stdbool.h>

double cubic_at(const double c[static 4], double s)
{
    return c[0] + s * (c[1] + s * (c[2] + s * c[3]));
}

double cubic_integral(const double c[static 4], double begin, double end)
{
    double at_end = end * (c[0] + end * (c[1] / 2.0 + end * (c[2] / 3.0 + end * c[3] / 4.0)));
    double at_begin = begin * (c[0] + begin * (c[1] / 2.0 + begin * (c[2] / 3.0 + begin * c[3] / 4.0)));

    return at_end - at_begin;
}

static int add_turn(double turn, double *turns, int count)
{
    if (!(turns[count - 1] < turn && turn < 1.0)) return count;
    turns[count] = turn;
    return count + 1;
}

// 0, the zeros of the derivative, and 1: the cubic is monotonic between two of them.
static int find_turns(const double c[static 4], double turns[static 4])
{
    // The derivative: a s^2 + 2 b s + c1.
    double a = 3.0 * c[3], b = c[2], square = b * b - a * c[1];
    int count = 1;

    turns[0] = 0.0;
    if (square > 0.0) {
        // The sign of the root is that of b, so that the sum loses no digits.
        double sum = -(b + copysign(sqrt(square), b));
        double first = sum / a, second = c[1] / sum;

        // One zero is not finite when the derivative is linear.
        if (!(first < second)) {
            double swap = first;

            first = second;
            second = swap;
        }
        count = add_turn(first, turns, count);
        count = add_turn(second, turns, count);
    }
    turns[count] = 1.0;
    return count + 1;
}

static double bisect(const double c[static 4], double level, double low, double high)
{
    bool is_above = cubic_at(c, low) > level;

    // Ends when no double lies between the two; 60 halvings of an interval of at most 1 suffice.
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);

        if (middle <= low || middle >= high) break;
        if ((cubic_at(c, middle) > level) == is_above) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return high;
}

int cubic_find_crossings(const double c[static 4], double level, double crossings[static 3])
{
    double turns[4];
    int turn_count = find_turns(c, turns), count = 0;

    for (int i = 1; i < turn_count; i++) {
        if ((cubic_at(c, turns[i - 1]) > level) == (cubic_at(c, turns[i]) > level)) continue;
        crossings[count++] = bisect(c, level, turns[i - 1], turns[i]);
    }
    return count;
}
