// Debug views: ONE table of the pictures of --set debug, and of the scales of their numbers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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
  const char* title;  // of the picture, with its unit
  uint kind;          // of kernels/results/results.h
  DebugSource source;
  // A percentile scale goes from the 3rd to the 97th percentile of the frame's surfaces. On a logarithmic one equal
  // factors of the absolute values are equal steps.
  DebugScale scale;
  float low;  // ends of fixed scales; values beyond have the colour of the end
  float high;
  bool is_grey;  // black to white instead of the colour ramp
};
std::vector<std::string> debug_view_names();

/// The rows that the settings ask for. Fails with ErrorKind::usage on an unknown name, listing the known ones.
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

/// Stages of the visibility, at the resolution of the estimate; null: none.
struct DebugStages {
  GBuffer gbuffer{};
  const gpu::Buffer* raw_ao = nullptr;
  Sites sites{};  // the pixels of raw_ao
  const gpu::Buffer* denoised_ao = nullptr;
  const gpu::Buffer* completed = nullptr;  // of the pixels of raw_ao; null: not asked for
  const gpu::Buffer* kinds = nullptr;      // of the tiles
  const gpu::Buffer* count = nullptr;      // of the frame's pixels: the number of averaged estimates
};
DebugPlane debug(gpu::Recorder& gpu, const DebugView& view, const GBuffer& gbuffer, const DebugStages& stages,
                 const FrameInputs& frame);

}  // namespace alcove
