// The head of a map of errors as a picture: its size, and the colours of cells that are good, fair, bad or refused.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// To stdout; the caller ends the picture with "</svg>".
void svg_map_begin(int width_px, int height_px);
