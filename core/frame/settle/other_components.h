// Other ways in which three channels may hold normals: in another order, or in two of them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "core/frame/find/frame_source.h"
#include "core/frame/pixels/normal_scores.h"

namespace alcove {

/// Tried channels, by their places among the three, and their reading.
struct OtherComponents {
  std::vector<std::size_t> channels;
  NormalEncoding encoding;
  bool unorm;
  NormalScore score;
};

/// Gives the order of vector components, or else the encoding of the first two channels, with the most normals within 3
/// degrees of depth. None if no order is clearly better than `score`, or if too little of the frame is smooth.
std::optional<OtherComponents> best_other_components(const NormalPlanes& planes, bool are_vectors,
                                                     const NormalScore& score);

/// The place of a channel that has one value on all surfaces while the two others vary, and that value.
struct ConstantComponent {
  std::size_t channel;
  float value;
  double bare;  // the share of surfaces without a normal
};
std::optional<ConstantComponent> constant_component(const RawPart& raw, const DepthMap& map);

/// Whether nearly all normals look the same way, as in tangent space.
bool are_alike(const RawPart& raw, const DepthMap& map);

}  // namespace alcove
