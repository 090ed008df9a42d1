// Shader modules of one medium's density.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct density_site;
struct shader_assembly;

// Adds the modules of the density's kind and bounds, and the job's own code; density_kind.write emits the rest.
void density_modules_add(struct shader_assembly *assembly, const struct density_site *site);
