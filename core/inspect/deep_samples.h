// What the deep parts of a file hold: how many samples, and whether any of them is hidden.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/formats/deep_surfaces.h"
#include "core/frame/gbuffer.h"

namespace alcove {

struct InspectedDeep {
  std::string file;
  std::vector<int> parts;  // whose samples were put together
  DeepLayout layout;       // of the first of them
  DeepCounts counts;       // over the whole file
  // "planar" or "along the ray", by the flat depth beside it; "the depth of the frame"; empty: nothing tells
  std::string depth;
  std::vector<std::string> channels;  // of the surfaces that its samples make, those that any pixel has

  double samples_per_pixel() const { return double(counts.samples) / double(counts.pixels); }
  /// Of the samples, those that lie behind an opaque one.
  double hidden_share() const { return double(counts.covered) / double(std::max<std::uint64_t>(1, counts.samples)); }
  /// Whether so few are hidden that the file was rendered in one go, up to the first opaque surface of each ray.
  bool shows_nothing_hidden() const { return hidden_share() < 1e-3; }
};

/// Reads all samples of a file of a frame that is settled, or that could not be; nothing where it has no deep parts.
/// Fails as reading them does.
std::optional<InspectedDeep> deep_samples(const FrameSource& source, const ExrFile& file,
                                          const InputSettings& settings);

}  // namespace alcove
