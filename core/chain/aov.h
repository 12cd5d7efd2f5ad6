// The AOVs that a run asks for, and what they ask of the chain.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/chain/debug_view.h"
#include "core/chain/outputs.h"
#include "core/frame/camera/camera.h"

namespace alcove {

/// An AOV that a run asks for: a row of kAovs, with the channels and planes that the other outputs' settings give it.
struct Aov {
  std::string name;
  std::vector<std::string> channels;
  gpu::Buffer* FrameOutputs::*planes;
  AovSource source;
  bool is_float;
};
std::vector<std::string> aov_names();

/// The AOVs that the settings ask for, each once, in their order. Fails with ErrorKind::usage on a name that is not in
/// the table, listing the names that are.
std::vector<Aov> aovs_of(const OutputSettings& settings);

/// How many planes of values an AOV has: ao-scales one for each radius, hidden two for each surface that is kept.
std::size_t planes_of(const Aov& aov, const EstimatorSettings& settings);
/// The channels of an AOV that has so many planes: scale1.Y of the smallest radius, hidden1.Z of the nearest surface.
std::vector<std::string> channels_of(const Aov& aov, std::size_t planes);

/// Whether an AOV that the settings ask for lies in these planes.
bool wants(const OutputSettings& settings, gpu::Buffer* FrameOutputs::*planes);

/// What the outputs ask of the chain: their names, parsed once. Settings convert to it, so they may be passed in its
/// place.
struct Wanted {
  /// Fails with ErrorKind::usage on names that are in no table.
  Wanted(const OutputSettings& settings);
  Wanted() : Wanted(OutputSettings{}) {}

  /// Whether an AOV lies in these planes.
  bool has(gpu::Buffer* FrameOutputs::*planes) const;
  /// Whether nothing is asked for but AO that is made from depth and normals alone.
  bool is_only_visibility() const;

  std::vector<Aov> aovs;
  std::vector<const DebugView*> debug_views;
  bool visibility = false;       // AO, or what is made from it
  bool open_directions = false;  // what is made from them, of an estimator that finds them
  bool completed = false;        // what completed surfaces took of the visibility
  bool only_own = false;         // the estimate alone, for other frames
  bool multi_bounce = false;
  PixelFilter filter;
  CompositeLook look;
};

/// Whether the directions that are given to the host are in world space.
bool in_world(const Camera& camera, const OutputSettings& settings);

/// Whether any output is AO or made from it.
bool needs_ao(const OutputSettings& output);

/// Whether any output is made from open directions, by an estimator that finds them.
bool needs_bent(const EstimatorSettings& settings, const Wanted& wanted);

}  // namespace alcove
