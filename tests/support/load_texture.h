// A job's textures and dome, read for the reference.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct job;
struct still_inputs;

// Reads the images of all objects and of a dome, other inputs being left as they are; fails the test when it cannot.
void load_texture_inputs(struct still_inputs *inputs, const struct job *job);
void load_texture_finish(struct still_inputs *inputs);
