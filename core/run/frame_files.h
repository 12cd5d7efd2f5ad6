// A frame's way from its files into the device's buffers, and from there into its outputs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/chain/chain.h"
#include "core/formats/color.h"
#include "core/formats/exr.h"
#include "core/formats/sheet.h"
#include "core/frame/find/frame_source.h"

namespace alcove {

/// Opens the frame that the settings name, with all planes for its outputs. Reads headers alone. Fails with
/// ErrorKind::input if the frame lacks a plane for an output. Fails with ErrorKind::usage if --roi is not within the
/// frame, or if the estimator cannot use --deep.
FrameSource open_frame(const Settings& settings, int frame);

/// The written window of a frame: its region, or the whole frame.
const Window& written_of(const FrameSource& source);
/// The window of its output files, smaller by the factor of supersampling.
Window written_picture(const FrameSource& source);

/// Decoded planes of a whole frame, in host memory; empty: not read.
using ReadPlanes = RawPlaneArray<std::vector<float>>;
/// The decoded planes of a frame that is computed at once.
ReadPlanes kept_planes(const FrameInputs& inputs);
/// Reads all planes into `known`, unless it has them, and settles the frame's reading with at most so many bytes.
void read_for_parts(FrameSource& source, const Settings& settings, ReadPlanes& known, std::uint64_t most_bytes);

/// Puts the planes over a window into upload buffers, and gives the planes with their meaning. The planes are from
/// `known` if it has all of them, else from the files. Settles the frame's reading if it is open; in this case the
/// window must be the whole frame.
FrameInputs load_frame(gpu::Recorder& gpu, FrameSource& source, const Window& window, const Settings& settings,
                       int frame, const ReadPlanes* known = nullptr);

/// The attribute that holds the warnings of an output's frame; an output without warnings has none.
inline constexpr const char* kNotesAttribute = "alcove/notes";

/// The origin of an output, for its header.
struct Provenance {
  std::string options, device;  // the digest of the settings, and the device's name
  std::string inputs = {};      // see InputIdentities
  std::string notes = {};       // see header_text()
  std::string others = {};      // see text_of(); empty: none are used
  std::string estimates = {};   // the same, of the averaged estimates
};

/// The radii of all scales, as headers have them; "" where none is known.
std::string radius_text(const EstimatorSettings& estimator);

/// The text that identifies a picture's options and inputs. --resume keeps a picture with this text.
std::string made_by(const std::string& options, const std::string& inputs);

/// The results over a window, plane by plane: the channels of the AO file, then the channels of the composite. If the
/// AO is a channel of the composite, it is the last one.
std::vector<std::span<const float>> result_planes(const FrameOutputs& outputs, const Window& computed,
                                                  const OutputSettings& settings);

/// The bytes for assembling a composite with another window than the AO; else 0.
std::uint64_t composite_bytes(const FrameSource& source);

/// The AO file and the composite, written from top to bottom, each whole or not at all. Fails with ErrorKind::output.
class FrameWriter {
 public:
  /// The source must outlive the writer, which reads the source if the beauty's window is larger than the written one.
  FrameWriter(FrameSource& source, const Settings& settings, const Provenance& provenance);
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  /// The next rows of result_planes(), as wide as the written window.
  void write(std::span<const std::span<const float>> planes);
  /// `notes`: the notes after all computing; see header_text().
  void finish(const std::string& notes);
  void finish() { finish(notes_); }

 private:
  /// Gives the files pixels of their own window.
  void write_pixels(std::span<const std::span<const float>> planes);
  /// The next computed rows of a composite with another window than the AO; the beauty's rows above them go first.
  void write_composite(std::span<const std::span<const float>> planes);
  void write_composite_until(int bottom, const Window& from, std::span<const std::span<const float>> planes);

  FrameSource& source_;
  int row_;                  // of the frame, the next one
  const std::string notes_;  // that the headers have
  std::vector<ExrWriter> files_;
  std::vector<std::size_t> planes_;   // the number of planes of each file
  std::optional<int> composite_row_;  // the next one of a composite with another window than the AO
  int computed_row_ = 0;              // the next computed one of the picture
};

/// A plane over a window, as it is, in the picture's display window; 0 where there are no pixels.
ShownPicture shown_plane(const FrameSource& source, const Window& window, const gpu::Buffer& planes,
                         std::size_t plane = 0);
/// The computed composite over a window, through the view transform; the beauty if `computed` is null.
ShownPicture shown_colors(FrameSource& source, const Window& window, const gpu::Buffer* computed,
                          const DisplayTransform* transform);

/// Takes a preview instead of its file.
using TakePreview = std::function<void(const ShownPicture&)>;

/// Writes the preview and the debug views over a window, of a frame that was computed at once. Each picture is written
/// whole or not at all. `transform` is for the preview of a composite, and may be null. `take_preview` may be empty.
/// Fails with ErrorKind::output.
void write_pictures(FrameSource& source, const Window& computed, const FrameOutputs& outputs,
                    const DisplayTransform* transform, const OutputSettings& settings, const Provenance& provenance,
                    const TakePreview& take_preview = {});

}  // namespace alcove
