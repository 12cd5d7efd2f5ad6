// A frame's way from its files into the device's buffers, and from there into its outputs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/chain/chain.h"
#include "core/formats/exr.h"
#include "core/formats/exr_copy.h"
#include "core/frame/gbuffer.h"
#include "core/run/composite_window.h"
#include "core/run/region.h"

namespace alcove {

/// The frame that the settings name, with all that its outputs need; nothing but headers is read.
/// Fails with ErrorKind::input where it lacks what an output is made from, with ErrorKind::usage where --roi is not
/// within it, or the estimator cannot use its --deep.
FrameSource open_frame(const Settings& settings, int frame);

/// What is written of a frame: its region, or all of it.
const Window& written_of(const FrameSource& source);
/// The window of the files that it is written to: as many pixels fewer as the frame is supersampled.
Window written_picture(const FrameSource& source);

/// Planes of a whole frame as they were read, in host memory; empty: those were not.
using ReadPlanes = RawPlaneArray<std::vector<float>>;
ReadPlanes kept_planes(const FrameInputs& inputs);
ReadPlanes read_whole(FrameSource& source);
/// Whether they are all that the frame needs.
bool are_of(const ReadPlanes& planes, const FrameSource& source);

/// Puts the planes within source.data into upload buffers: from those of the whole frame that are known, where these
/// are all, or else from the files.
RawPlaneArray<gpu::Buffer*> read_frame(gpu::Recorder& gpu, FrameSource& source, const ReadPlanes* known = nullptr);

/// Settles what is open about a frame whose planes are read, and says what they mean.
FrameInputs settled_inputs(FrameSource& source, const RawPlaneArray<gpu::Buffer*>& planes, const Settings& settings,
                           int frame);

/// Does both.
FrameInputs load_frame(gpu::Recorder& gpu, FrameSource& source, const Settings& settings, int frame,
                       const ReadPlanes* known = nullptr);

/// The attribute that holds the warnings of an output's frame; an output without warnings has none.
inline constexpr const char* kNotesAttribute = "alcove/notes";

/// The attribute that tells what frames and views a frame has taken surfaces from.
inline constexpr const char* kHiddenAttribute = "alcove/hidden";
inline constexpr const char* kAccumulatedAttribute = "alcove/accumulated";

/// What the header of an output says of its making.
struct Provenance {
  std::string options, device;  // the digest of the settings, and the device's name
  std::string inputs = {};      // see InputIdentities
  std::string notes = {};       // see header_text()
  std::string others = {};      // see text_of(); empty: it takes none
  std::string estimates = {};   // the same, of those that the AO is a mean of
};

/// The text that tells in a picture what it was made with: whoever finds it there need not make the picture again.
std::string made_by(const std::string& options, const std::string& inputs);

/// The results over a window, plane by plane: the AO file's channels, then the composite's, the AO last where it is one
/// of them.
std::vector<std::span<const float>> result_planes(const FrameOutputs& outputs, const Window& computed,
                                                  const OutputSettings& settings);

/// The AO file and the composite, written from top to bottom, each whole or not at all. Fails with ErrorKind::output.
class FrameWriter {
 public:
  /// The source must stay: where the beauty has another window than what is written of the frame, the rest is read.
  FrameWriter(FrameSource& source, const Settings& settings, const Provenance& provenance);

  /// The next rows of result_planes(), as wide as what is written of the frame.
  void write(std::span<const std::span<const float>> planes);
  /// `notes` is what is noted now that all is computed; see header_text().
  void finish(const std::string& notes);
  void finish() { finish(notes_); }

 private:
  /// Gives the files pixels of their own window.
  void write_pixels(std::span<const std::span<const float>> planes);

  const FrameSource& source_;
  int row_;                  // of the frame, the next one
  const std::string notes_;  // that the headers have
  std::vector<std::variant<ExrWriter, ExrCopy>> files_;
  std::vector<std::size_t> planes_;         // the number of planes of each file
  std::optional<CompositeRows> composite_;  // where it has another window than the AO
};

}  // namespace alcove
