// The order of the passes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/passes.h"

namespace alcove {

/// What the host reads after the recorder has run; null: not asked for.
struct FrameOutputs {
  gpu::Buffer* counts = nullptr;              // one FrameCounts
  gpu::Buffer* tiles = nullptr;               // one TileCounts, where there is an estimate
  gpu::Buffer* confidence = nullptr;          // a plane, in [0, 1]
  gpu::Buffer* error = nullptr;               // a plane: with settings.tolerance, the estimated error of the visibility
  gpu::Buffer* squares = nullptr;             // with settings.tolerance, vec2 a tile: sum of its squares, and receivers
  gpu::Buffer* ao = nullptr;                  // a plane: visibility in [0, 1]; of several radii the mean
  gpu::Buffer* scales = nullptr;              // a plane a radius, from the smallest on
  gpu::Buffer* color_ao = nullptr;            // planes r, g, b: the visibility with multi-bounce
  gpu::Buffer* composite = nullptr;           // the beauty's planes
  gpu::Buffer* normal = nullptr;              // planes x, y, z; 0 for sky
  gpu::Buffer* bent_normal = nullptr;         // planes x, y, z; 0 for sky
  gpu::Buffer* depth = nullptr;               // a plane: planar, scene units; kSkyDepth for sky
  gpu::Buffer* specular_occlusion = nullptr;  // a plane, in [0, 1], 1 = open
  std::vector<DebugPlane> debug;
};

/// Records for one frame what `output` asks for, and the composite where the frame has a beauty. settings.radius must
/// be set where that needs AO.
FrameOutputs run_chain(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings,
                       const OutputSettings& output = {});

/// Whether any of it is AO or made from it.
bool needs_ao(const OutputSettings& output);

/// Whether any of it is made from open directions, by an estimator that finds them.
bool needs_bent(const EstimatorSettings& settings, const OutputSettings& output);

}  // namespace alcove
