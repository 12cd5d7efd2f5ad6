// What to write; see settings.h. No code.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/base/setting_words.h"

namespace alcove {

/// How AO goes into the beauty: see composite.comp.
struct CompositeLook {
  // 1 / scene units, >= 0: of the exponential fog in the beauty, which hides AO
  double fog_density = 0;
  double gain = 1;                      // factor on the occlusion, 0 to 100
  std::array<double, 3> tint{0, 0, 0};  // what occlusion makes of white light, each 0 to 1
  double mix = 1;                       // of the composite and the beauty, 0 to 1
};

/// How pixels of a G-buffer that is larger than the picture make one of the picture's.
struct PixelFilter {
  PixelFilterKind kind = PixelFilterKind::blackman_harris;
  std::optional<double> width;  // px of the picture from one end to the other, 1 to 16; none: see usual_width()
};
/// As renderers set it: Arnold and RenderMan 2 for Gaussian; Cycles 3 for Blackman-Harris, of which it says half.
constexpr double usual_width(PixelFilterKind kind) {
  return kind == PixelFilterKind::box ? 1 : kind == PixelFilterKind::gaussian ? 2 : 3;
}

/// What to write.
struct OutputSettings {
  std::string output;     // the AO EXR
  std::string composite;  // the composite EXR
  std::string preview;    // a PNG, see preview_style
  // what the file of `output` holds: names of AOVs with commas, see core/chain/results/outputs.h
  std::string aovs = "ao";
  // mono: Y; rgb: R, G, B, as compositors' shuffles expect, and coloured with multi_bounce
  AoChannels ao_channels = AoChannels::mono;
  // of directions; automatic: world where the camera has world_to_camera, else view
  NormalSpace aov_space = NormalSpace::automatic;
  // light thrown back by the occluders brightens the rgb AO, and the composite's ambient light
  bool multi_bounce = false;
  PixelFilter filter;  // with InputSettings::supersampling
  CompositeLook look;
  // all: the composite is the beauty's file with another beauty; rgba: R, G, B and A alone
  std::string composite_layers = "all";
  // of the beauty in the composite, as that of ExrOutput; keep: as the file has it, or zip if that loses bits
  std::string composite_compression = "keep";
  std::string append_ao;  // a channel of the composite that the AO becomes, or its layer; empty: none
  // of the AO in `output`: its channel, or with rgb its layer; empty: Y, or R, G, B
  std::string ao_name;
  // names of core/chain/results/debug.h with commas: a picture of each beside `output`
  std::string debug;
  OutputType type = OutputType::half_float;  // of all channels of `output` but depth, which is float
  std::string compression = "zip";           // of the AO file: none, rle, zips, zip or piz
  std::string ocio;                          // an OpenColorIO configuration for the preview
  std::string display, view_transform;       // of it; empty: its default ones
  // auto: the composite, or the AO where there is none; ao; composite; split: the beauty beside the composite
  std::string preview_style = "auto";
  std::string stats;      // a JSON file
  bool no_mkdir = false;  // a folder that is missing is an error, and is not made
  // a file of JSON objects, one per line, or - for the standard output; whoever watches the run writes it
  std::string log_json;
};

}  // namespace alcove
