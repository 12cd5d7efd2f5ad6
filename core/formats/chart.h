// What a debug view hands to those who draw it. A value type.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace alcove {

/// A picture of one number a pixel, with a scale below it.
struct Chart {
  int width, height;             // px; small pictures are drawn with larger pixels
  std::vector<float> places;     // on the scale, 0 to 1; NaN: sky, which has a colour of its own
  std::string title, low, high;  // texts: what it shows, and the numbers at the ends of the scale
  std::string made_by;           // see encode_png()
  bool is_grey;                  // black to white; else a ramp that brightens evenly
};

}  // namespace alcove
