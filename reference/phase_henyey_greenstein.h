// Henyey and Greenstein's phase function, normalised over the sphere (Astrophysical Journal 93, 1941).
// SPDX-License-Identifier: Apache-2.0
#pragma once

// g in (-1, 1), forward positive; `cos_theta` between the directions of travel before and after.
double phase_henyey_greenstein(double g, double cos_theta);
