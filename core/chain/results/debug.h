// Pictures that explain themselves: ONE table of what --set debug shows, and of the scales that its numbers have.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/chain/estimate/sites.h"
#include "core/chain/geometry/geometry.h"

namespace alcove {

enum class DebugScale { fixed, fixed_logarithmic, percentile, percentile_logarithmic };
/// The input of kernels/results/debug.comp beside the G-buffer.
enum class DebugSource {
  none,
  raw_depth,
  raw_ao,
  denoised_ao,
  normals_from_depth,
  completed,
  sites,
  tiles,
  hidden,
  count
};

/// A row of the table.
struct DebugView {
  const char* name;   // as --set debug takes it
  const char* title;  // what the picture shows, and its unit
  uint kind;          // of kernels/results/results.h
  DebugSource source;
  // A percentile scale goes from the 3rd to the 97th of the frame's surfaces. On a logarithmic one equal factors are
  // equal steps, by the numbers' sizes.
  DebugScale scale;
  float low;  // ends of fixed scales; what is beyond has the colour of the end
  float high;
  bool is_grey;  // black to white instead of the colour ramp
};
std::span<const DebugView> debug_view_table();
std::vector<std::string> debug_view_names();

/// The rows that the settings ask for. Fails with ErrorKind::usage on a name that is not in the table, listing what is.
std::vector<const DebugView*> debug_views_of(const OutputSettings& settings);
/// Whether the settings ask for a view of this source.
bool shows(const OutputSettings& settings, DebugSource source);

/// The path of a view's picture: beside the AO, ao.exr -> ao.raw-depth.png.
std::string debug_path(const OutputSettings& settings, const DebugView& view);

/// One number per pixel for a debug view; kSkyDepth for sky.
struct DebugPlane {
  const DebugView* view;
  ivec2 size;  // px
  gpu::Buffer* values;
};

/// The visibility on its way, at the resolution of the estimate; null where there is none.
struct DebugStages {
  GBuffer gbuffer{};
  const gpu::Buffer* raw_ao = nullptr;
  Sites sites{};  // the pixels that raw_ao is of
  const gpu::Buffer* denoised_ao = nullptr;
  const gpu::Buffer* completed = nullptr;  // of the pixels of raw_ao; null: not asked for
  const gpu::Buffer* kinds = nullptr;      // of the tiles
  const gpu::Buffer* count = nullptr;      // of the frame's pixels: of how many frames' estimates each is the mean
};
DebugPlane debug(gpu::Recorder& gpu, const DebugView& view, const GBuffer& gbuffer, const DebugStages& stages,
                 const FrameInputs& frame);

}  // namespace alcove
