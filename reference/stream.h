// Random numbers in streams of their own: 64 bits of state, and a step that differs from stream to stream.
// SPDX-License-Identifier: Apache-2.0
// SplitMix: Steele, Lea and Flood, Fast Splittable Pseudorandom Number Generators, OOPSLA 2014.
#pragma once

#include <stdint.h>

struct stream {
    uint64_t state, step;
    uint64_t drawn; // numbers so far
};

static inline uint64_t stream_mix(uint64_t value)
{
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
    return value ^ (value >> 31);
}

// The stream of a number, such as a path's, of all those that belong to a seed.
static inline struct stream stream_of(uint64_t seed, uint64_t number)
{
    uint64_t start = stream_mix(seed + 0x9e3779b97f4a7c15u * (number + 1)), step;

    step = stream_mix(start ^ 0xd1b54a32d192ed03u) | 1;
    // A step whose bits rarely change would count, not mix.
    if (__builtin_popcountll(step ^ (step >> 1)) < 24) step ^= 0xaaaaaaaaaaaaaaaau;
    return (struct stream){.state = start, .step = step | 1};
}

// Even in [0, 1): 53 random bits.
static inline double stream_draw(struct stream *stream)
{
    stream->state += stream->step;
    stream->drawn++;
    return (double)(stream_mix(stream->state) >> 11) * 0x1p-53;
}
