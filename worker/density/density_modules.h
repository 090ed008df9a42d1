// The shader modules of one medium's density.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct density_site;
struct shader_assembly;

// Adds the modules of the density's kind and bounds, and the job's own code, but for what density_kind.write emits.
void density_modules_add(struct shader_assembly *assembly, const struct density_site *site);
