// What to write; see settings.h. No code.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/setting_words.h"

namespace alcove {

/// What to write.
struct OutputSettings {
  std::string output;     // the AO EXR
  std::string composite;  // the composite EXR
  std::string preview;    // a PNG of the composite, or of the AO where there is none
  // what the file of `output` holds: names of AOVs with commas, see core/chain/outputs.h
  std::string aovs = "ao";
  // mono: Y; rgb: R, G, B, as compositors' shuffles expect, and coloured with multi_bounce
  AoChannels ao_channels = AoChannels::mono;
  // of directions; automatic: world where the camera has world_to_camera, else view
  NormalSpace aov_space = NormalSpace::automatic;
  // light thrown back by the occluders brightens the rgb AO, and the composite's ambient light
  bool multi_bounce = false;
  // 1 / scene units, >= 0: of the exponential fog in the beauty, which hides AO from the composite
  double fog_density = 0;
  // names of core/chain/debug_view.h with commas: a picture of each beside `output`
  std::string debug;
  OutputType type = OutputType::half_float;  // of all channels of `output` but depth, which is float
  std::string compression = "zip";           // of the AO file: none, rle, zips, zip or piz
  std::string ocio;                          // an OpenColorIO configuration for the preview
  std::string stats;                         // a JSON file
  bool no_mkdir = false;                     // a folder that is missing is an error, and is not made
  // a file of JSON objects, one per line, or - for the standard output; whoever watches the run writes it
  std::string log_json;
};

}  // namespace alcove
