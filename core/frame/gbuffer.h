// Finds the AOVs of a frame in its files and describes them completely; the only code that knows renderers' names.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/note.h"
#include "core/base/settings.h"
#include "core/formats/exr.h"
#include "core/frame/channels.h"
#include "core/frame/flatness.h"
#include "core/frame/input_rules.h"
#include "core/frame/raw_plane.h"
#include "core/frame/reading.h"

namespace alcove {

/// Something that neither settings nor camera say, and what was chosen.
struct Guess {
  std::string what, chosen, why, option;  // option: the one that says it
};

/// FrameSource::camera_from where the pass of positions gave the camera.
inline constexpr const char* kByPositions = "its positions";

/// Deep samples that are the depth of a frame, or give planes behind it.
struct DeepFiles {
  std::size_t file;        // of FrameSource::files
  std::vector<int> parts;  // of that file
  // other files and their parts, whose samples count together with those
  std::vector<std::pair<std::size_t, std::vector<int>>> elements = {};
  Window data = {};            // over which samples are read
  bool depth_is_half = false;  // samples are the depth, and were rounded to half floats
};

/// The channels of a frame that are read.
struct FrameChannels {
  /// The channels of a plane, in the order of its components; none: the frame has no such plane, or nobody asked for
  /// it. The indirect diffuse light is to be multiplied by the diffuse colour where that is there, and holds it already
  /// where it is not.
  std::vector<ChannelRef>& operator[](RawPlane plane) { return planes[plane]; }
  const std::vector<ChannelRef>& operator[](RawPlane plane) const { return planes[plane]; }

  RawPlaneArray<std::vector<ChannelRef>> planes;
  std::vector<ChannelRef> positions;  // that may tell the camera; empty: there are none
  std::optional<DeepFiles> deep;
  std::string view;  // that is read, of files with views
};

/// The program that wrote a frame, and how it usually means depth and normals.
struct Program {
  /// FrameSource::program.by where the option --source names the rules.
  static constexpr const char* kByOption = "--source";

  const InputRules* rules = nullptr;
  std::string by;  // the attribute or channel, or the option, that told; empty: nothing did
  DepthKind depth_kind = DepthKind::planar;
  NormalSpace normal_space = NormalSpace::world;

  /// Whether an option names the rules: then they are no guess.
  bool is_said() const { return by == kByOption; }
};

/// Facts of a frame that neither settings nor headers say.
struct OpenQuestions {
  // The pixels decide these.
  bool depth_kind = false, normal_space = false, normal_encoding = false;
  // The camera only stands in for one, so that the pixels cannot speak against it.
  bool camera = false;
};

/// Facts that the pixels of a frame show.
struct Evidence {
  bool tells = true;                     // false: the pixels did not show what was left open
  Grain grain;                           // of the depth's values
  std::vector<DepthScore> depth_scores;  // of depth that is no position
  // of the surfaces, scene units; none until the frame is settled, and where all is sky
  std::optional<double> median_depth;
  std::vector<Guess> guesses;
};

/// A frame that was found: its files, the channels of its planes, and how they are read. Nothing but headers is read to
/// find it.
struct FrameSource {
  /// The file of the depth or the positions, after which the frame is called in messages.
  const std::string& depth_path() const { return files[channels[RawPlane::depth][0].file].path(); }
  /// The file of the normals for notes on them: "" where it is the frame's own, or where there are none.
  std::string normal_file() const {
    const auto& normal = channels[RawPlane::normal];
    return normal.empty() || normal[0].file == channels[RawPlane::depth][0].file ? "" : files[normal[0].file].path();
  }
  /// The part of a file that a channel lies in.
  const ExrPart& part_of(const ChannelRef& ref) const { return files[ref.file].parts()[std::size_t(ref.part)]; }
  /// Whether its samples are half floats.
  bool is_half(const ChannelRef& ref) const;
  /// The name of a channel without its last part, which a part's name stands for; "" where it has no layer.
  std::string layer_of(const ChannelRef& ref) const;

  std::vector<ExrFile> files;
  FrameChannels channels;  // of those files
  Reading reading;         // over all pixels that the files hold
  Program program;
  OpenQuestions open;
  std::string camera_from;       // the header's attributes or the positions, which gave it; empty: the settings did
  std::optional<Window> region;  // that is written; none: all pixels are
  bool settled = false;          // see core/frame/settle.h
  Evidence evidence;
  Notes notes;                  // guesses that are unusual, and options that the pixels speak against
  Notes suspicious;             // on faults of the files that harm AO
  std::uint64_t rows_read = 0;  // that were decoded, each as often as it was
};

/// Opens the files that the settings name and finds the channels. `with_beauty` asks for the beauty and its ambient
/// parts too, `with_albedo` for the diffuse colour.
/// Fails with ErrorKind::input, listing what there is and naming the option that decides, when a channel is not found,
/// is found twice, is subsampled, or has another size than the depth; with NoCamera where nothing gives one.
FrameSource find_frame(const InputSettings& settings, bool with_beauty, int frame, bool with_albedo = false);

/// What to do about normals in world space where the camera has no world_to_camera.
constexpr const char* kWorldWithoutMatrix =
    "its normals are in world space, and the camera has no world_to_camera: give a --camera file with it, or --normal "
    "none, which reconstructs them from depth";

/// Whether the header of the frame's depth or position file has a camera, or why it has none is known, or the file has
/// positions, which may tell one. Fails as opening it does.
bool may_tell_camera(const InputSettings& settings);

/// The settings with a camera that stands in for one where nothing gives any, so that all else can be looked at.
InputSettings with_some_camera(const InputSettings& settings);

/// A plane, or several one behind the other, and where it goes.
struct PlaneRead {
  const std::vector<ChannelRef>* channels;
  float* to;
};

/// Reads planes over a window, which is as wide as the frame. Every part of every file is decoded once.
void read_planes(FrameSource& source, const Window& window, const std::vector<PlaneRead>& reads);

/// Depth and normals of a part of a frame, as they were read.
struct RawPart {
  Window window;
  std::span<const float> depth, normal;
};
/// Depth and normals of a frame, as they were read.
struct RawFrame {
  std::vector<float> depth, normal;
};
RawFrame read_raw_frame(FrameSource& source, const Window& window);

/// Finds, reads and settles the depth and normals that the settings name. Fails as find_frame() and settle() do.
HostFrame read_host_frame(const InputSettings& settings, int frame);

// Planes whose files have another data window than the depth, or are of a picture that is so many times smaller.

/// How many pixels of the depth, in x and in y, are one of a beauty's: what the option says, or with auto as their
/// display windows have it, and 1 where they are of no such size. Fails with ErrorKind::input where the depth's window
/// cannot be divided so, or the beauty's is another.
int supersampling_of(const FrameSource& source, const ChannelRef& beauty, const InputSettings& settings);
/// The same without a beauty: 1 with auto.
int supersampling_of(const FrameSource& source, const InputSettings& settings);

/// Fails with ErrorKind::input where channels, what they hold and the option that names them, have another data window
/// than the depth and no pixel in common with it, or another display window, which alone shows which pixels belong
/// together. A renderer may have cut each plane to its own pixels that are not 0.
void require_same_picture(const FrameSource& source, const std::vector<ChannelRef>& channels, const char* what,
                          const char* option);

/// Fails with ErrorKind::input where channels, what they hold and the option that names them, share no pixel with the
/// depth, or have another data window than it and a display window that is neither its own nor the picture's, since
/// nothing then tells which pixels belong together. Notes another data window; `without` says what holds where one of
/// them has no pixels.
void require_common_window(FrameSource& source, const std::vector<ChannelRef>& channels, const char* what,
                           const char* option, const char* without);

/// Puts values that change nothing into the pixels of a plane over a window that its files do not have: AO 1 of
/// materials, no object of a matte. Of all other planes that is the 0 that is there.
void fill_missing(const FrameSource& source, const Window& window, RawPlane plane, std::span<float> values);

}  // namespace alcove
