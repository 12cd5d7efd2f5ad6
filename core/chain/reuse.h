// What a frame has in common with the one before it in the same buffers: all of it, or blocks of its pixels.
// SPDX-License-Identifier: BSD-3-Clause
//
// A result may be used again where every value that it is made from is the same: the frame's recipe, which is
// compared, and the raw planes, by 64-bit hashes (XXH3). Settings are those of the run. That needs noise that is the
// same in every frame (Noise::fixed).
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
  /// Whether all that the frame's results are made from is as it was: then outputs() are its own. If only some blocks
  /// of its pixels are as they were, frame.changes says which. Call it once the planes are read, and keep() once the
  /// frame is computed; until then nothing is remembered.
  bool is_same(gpu::Recorder& gpu, FrameInputs& frame, const EstimatorSettings& settings);
  /// Whether frames take longer to compute than to compare, by what was said of the last; where nothing was, they may.
  bool is_worth_comparing(const FrameInputs& frame) const;
  /// Says how long the device took for a frame of which all was computed; 0: it has no clock.
  void took(double ms) { ms_ = ms; }
  void keep(const FrameOutputs& outputs) { outputs_ = outputs; }
  void forget() { outputs_.reset(); }

  const FrameOutputs& outputs() const { return outputs_.value(); }

 private:
  /// What a frame was made from; of planes their hashes.
  struct Past {
    struct Whole {
      FrameRecipe recipe;
      std::optional<int> noise_frame;  // by which animated noise goes on; fixed: 0
      std::array<std::size_t, kRawPlanes.size()> bytes{};
      std::uint64_t selection = 0;
      bool operator==(const Whole&) const = default;
    } whole;                            // where it differs, no block is as it was
    std::uint64_t colors = 0;           // of planes that no estimate is made from
    std::vector<std::uint64_t> blocks;  // of those that one is made from
    bool operator==(const Past&) const = default;
  };
  static Past past_of(const FrameInputs& frame, const EstimatorSettings& settings);

  Past last_;
  double ms_ = 0;  // of a whole frame; 0: nobody knows
  std::optional<FrameOutputs> outputs_;
};

}  // namespace alcove
