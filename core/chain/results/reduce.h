// Filters the pixels of a G-buffer to a smaller picture, as renderers filter their samples.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/settings.h"
#include "core/chain/base/frame_inputs.h"
#include "core/chain/results/outputs.h"

namespace alcove {

/// The weights, along an axis, of a block's `factor` pixels and of as many pixels to its left as to its right, from the
/// left on. They need not add up to 1.
struct FilterWeights {
  int first = 0;  // px from the block's first pixel, at most 0
  std::vector<float> weights;
};
/// `filter`: its width in pixels of the smaller picture. Box: all the same; Gaussian: exp(-2 (2 x / width)^2), as
/// RenderMan and Arnold have it; Blackman-Harris: the window of four terms (Harris, On the Use of Windows for Harmonic
/// Analysis with the Discrete Fourier Transform, 1978), as Cycles has it. A pixel counts by its centre.
FilterWeights filter_weights(const PixelFilter& filter, int factor);

/// The number of pixels beyond a part of a frame that count for it; 0 with the factor 1.
int reduce_reach(const PixelFilter& filter, int factor);

/// Filters amounts and directions if the frame is larger than its picture: all pixels of a block then have the
/// picture's value. Depths stay.
FrameOutputs reduce(gpu::Recorder& gpu, const FrameInputs& frame, const PixelFilter& filter, const FrameOutputs& out);

}  // namespace alcove
