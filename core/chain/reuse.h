// Reuse of results of the frame before in the same buffers: of all of them, or of blocks of pixels.
// SPDX-License-Identifier: BSD-3-Clause
//
// A result is reused if everything that decides it is equal: the frame's recipe, which is compared as a value, and the
// raw planes, by 64-bit hashes (XXH3). The settings are those of the run. This needs Noise::fixed.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/chain/chain.h"

namespace alcove {

/// Remembers the last frame that went through a recorder's buffers. Each recorder has one of its own.
class LastFrame {
 public:
  /// Whether everything that decides the frame's results is unchanged: then outputs() has them. If only some blocks of
  /// pixels are unchanged, frame.changes marks the changed ones. Call it once the planes are read, and keep() once the
  /// frame is computed; until then nothing is remembered.
  bool is_same(gpu::Recorder& gpu, FrameInputs& frame, const EstimatorSettings& settings);
  /// Whether frames take longer to compute than to compare, by the time of the last; true without one.
  bool is_worth_comparing(const FrameInputs& frame) const;
  /// Sets the device time of a frame that was computed as a whole; 0: the device has no clock.
  void took(double ms) { ms_ = ms; }
  void keep(const FrameOutputs& outputs) { outputs_ = outputs; }
  void forget() { outputs_.reset(); }

  const FrameOutputs& outputs() const { return outputs_.value(); }

 private:
  /// Everything that decides a frame's results; of planes their hashes.
  struct Past {
    struct Whole {
      FrameRecipe recipe;
      std::optional<int> noise_frame;  // by which animated noise goes on; fixed: 0
      std::array<std::size_t, kRawPlanes.size()> bytes{};
      std::uint64_t selection = 0;
      bool operator==(const Whole&) const = default;
    } whole;                            // where it differs, no block is as it was
    std::uint64_t colors = 0;           // of planes that change no estimate
    std::vector<std::uint64_t> blocks;  // of the others
    bool operator==(const Past&) const = default;
  };
  static Past past_of(const FrameInputs& frame, const EstimatorSettings& settings);

  Past last_;
  double ms_ = 0;  // of a whole frame; 0: unknown
  std::optional<FrameOutputs> outputs_;
};

}  // namespace alcove
