// A frame's way from its files into the device's buffers, and from there into its outputs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/chain/chain.h"
#include "core/formats/exr.h"
#include "core/frame/gbuffer.h"
#include "core/run/region.h"

namespace alcove {

/// The frame that the settings name, with all that its outputs need; nothing but headers is read.
/// Fails with ErrorKind::input where it lacks what an output is made from, with ErrorKind::usage where --roi is not
/// within it.
FrameSource open_frame(const Settings& settings, int frame);

/// What is written of a frame: its region, or all of it.
const Window& written_of(const FrameSource& source);

/// Reads the planes within source.data into upload buffers, and says what they mean. Settles what is open.
FrameInputs load_frame(gpu::Recorder& gpu, FrameSource& source, const Settings& settings, int frame);

/// What the header of an output says of its making.
struct Provenance {
  std::string options, device;  // the digest of the settings, and the device's name
  std::string inputs = {};      // see identity_of_inputs()
};

/// The text that tells in a picture what it was made with: whoever finds it there need not make the picture again.
std::string made_by(const std::string& options, const std::string& inputs);

/// The results over a window, plane by plane: the AO file's channels, then the composite's.
std::vector<std::span<const float>> result_planes(const FrameOutputs& outputs, const Window& computed,
                                                  const OutputSettings& settings);

/// The AO file and the composite, written from top to bottom, each whole or not at all. Fails with ErrorKind::output.
class FrameWriter {
 public:
  FrameWriter(const FrameSource& source, const Settings& settings, const Provenance& provenance);

  /// The next rows of result_planes(), as wide as what is written.
  void write(std::span<const std::span<const float>> planes);
  void finish();

 private:
  std::vector<ExrWriter> files_;
  std::vector<std::size_t> planes_;  // the number of planes of each file
};

}  // namespace alcove
