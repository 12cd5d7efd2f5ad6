// Finds the AOVs of a frame in its files and describes them completely; the only code that knows renderers' names.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/note.h"
#include "core/base/settings.h"
#include "core/formats/exr.h"
#include "core/frame/find/channels.h"
#include "core/frame/find/input_rules.h"
#include "core/frame/find/lights.h"
#include "core/frame/raw_plane.h"
#include "core/frame/reading.h"

namespace alcove {

/// FrameSource::camera_from where the pass of positions gave the camera.
inline constexpr const char* kByPositions = "its positions";

/// Deep samples that are the depth of a frame, or give planes behind it.
struct DeepFiles {
  struct Element {
    std::size_t file;        // of FrameSource::files
    std::vector<int> parts;  // of that file
  };
  std::vector<Element> elements;  // their samples count together; channels name the first one's
  Window data = {};               // the pixels of the samples
  bool depth_is_half = false;     // samples are the depth, and were rounded to half floats
};

/// The channels of a frame that are read.
///
/// A plane's channels are in the order of its components. A plane without channels is one that the frame lacks, or that
/// nobody asked for. The indirect diffuse light is to be multiplied by the diffuse colour where that is there, and
/// holds it already where it is not.
struct FrameChannels : RawPlaneArray<std::vector<ChannelRef>> {
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

/// A frame that was found: its files, the channels of its planes, and how they are read. Nothing but headers is read to
/// find it.
struct FrameSource {
  /// The file of the depth or the positions; messages call the frame by it.
  const std::string& depth_path() const { return path_of(RawPlane::depth); }
  /// The file of a plane for notes on it: "" for the frame's own name, or without a file.
  std::string note_file(RawPlane plane) const {
    return channels[plane].empty() || path_of(plane) == main_file ? "" : path_of(plane);
  }
  /// The file of a channel, and of a plane.
  ExrFile& file_of(const ChannelRef& ref) { return files[ref.file]; }
  const ExrFile& file_of(const ChannelRef& ref) const { return files[ref.file]; }
  const std::string& path_of(RawPlane plane) const { return file_of(channels[plane][0]).path(); }
  /// The part of a file that a channel lies in.
  const ExrPart& part_of(const ChannelRef& ref) const { return file_of(ref).parts()[std::size_t(ref.part)]; }
  /// Whether its samples are half floats.
  bool is_half(const ChannelRef& ref) const {
    const auto& channels = part_of(ref).channels;
    const auto channel = std::ranges::find(channels, ref.channel, &ExrChannel::name);
    return channel != channels.end() && channel->type == SampleType::half_float;
  }
  /// The layer of a channel: its name without the last part, else the part's name; "" without a layer.
  std::string layer_of(const ChannelRef& ref) const {
    const std::size_t dot = ref.channel.rfind('.');
    return dot == ref.channel.npos ? part_of(ref).name : ref.channel.substr(0, dot);
  }

  std::string main_file;  // see main_input()
  std::vector<ExrFile> files;
  FrameChannels channels;  // of those files
  Reading reading;         // over all pixels that the files hold
  Program program;
  OpenQuestions open;
  std::string camera_from;       // the header's attributes or the positions, which gave it; empty: the settings did
  std::optional<Window> region;  // that is written; none: all pixels are
  // by which the frame is settled, see core/frame/settle/settle.h; none: it is not yet
  std::optional<Evidence> evidence;
  Notes notes;                             // guesses that are unusual, and options that the pixels speak against
  Notes suspicious;                        // on faults of the files that harm AO
  std::optional<Environment> environment;  // that the settings name
  std::uint64_t rows_read = 0;             // that were decoded, each as often as it was
};

/// Opens the files that the settings name and finds the channels. `with_beauty` asks for the beauty and its ambient
/// parts too, `with_albedo` for the diffuse colour.
/// Fails with ErrorKind::input if a channel is not found, is found twice, is subsampled, or has another size than the
/// depth; the message lists the channels and names the option that decides. Fails with NoCamera if nothing gives one.
FrameSource find_frame(const InputSettings& settings, bool with_beauty, int frame, bool with_albedo = false);

/// Other channels of the depth's file that are depth by their names, over the same pixels. Options name none of them.
std::vector<std::string> other_depths(const FrameSource& source);

/// Whether the renderer's normals are in world space, and no option says otherwise: a camera must turn them.
inline bool expects_world_normals(const FrameSource& source, const InputSettings& settings) {
  return !source.channels[RawPlane::normal].empty() && source.program.rules->normal_space == NormalSpace::world &&
         settings.normal_space != NormalSpace::view;
}

/// ErrorKind::input: the normals of this file are in world space, and the camera has no world_to_camera.
struct NoWorldToCamera : Error {
  explicit NoWorldToCamera(const std::string& file);
};

/// Whether the file of the depth or the positions may tell a camera: its header has one, or looks as if it had, or the
/// file has positions. Fails as opening it does.
bool may_tell_camera(const InputSettings& settings);

/// Gives the settings with a camera that stands in for one, so that all else can be inspected without a camera.
inline InputSettings with_some_camera(const InputSettings& settings) {
  InputSettings with = settings;
  with.fov = 50;
  if (with.normal_space == NormalSpace::automatic) with.normal_space = NormalSpace::view;
  return with;
}

/// A plane, or several one behind the other, and its destination.
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
/// The same in vectors of its own.
struct RawFrame {
  Window window;
  std::vector<float> depth, normal;

  operator RawPart() const { return {window, depth, normal}; }
};
RawFrame read_raw_frame(FrameSource& source, const Window& window);

/// Finds, reads and settles the depth and normals that the settings name. Fails as find_frame() and settle() do.
HostFrame read_host_frame(const InputSettings& settings, int frame);

// Planes of files with another data window than the depth, or of a smaller picture.

/// Gives the pixels of the depth, in x and in y, per pixel of the picture that is written, as the option says; 1 with
/// auto. Fails with ErrorKind::input if it does not divide the depth's display window. With a beauty, also fails if the
/// beauty's display window is not that of the divided picture; with a factor of 1, only if it is 2, 3 or 4 times
/// smaller.
int supersampling_of(const FrameSource& source, const InputSettings& settings, const ChannelRef* beauty = nullptr);

/// Fails with ErrorKind::input if channels have another data window than the depth, and either share no pixel with it
/// or have another display window: nothing else tells which pixels belong together. A renderer may cut each plane to
/// its pixels that are not 0. `what` names the channels' content, `option` their option.
void require_same_picture(const FrameSource& source, const std::vector<ChannelRef>& channels, const char* what,
                          const char* option);

/// Does the same for channels that may be of the smaller picture: their display window is the depth's or the picture's.
/// Notes another data window; `without` describes the pixels that the channels lack.
void require_common_window(FrameSource& source, const std::vector<ChannelRef>& channels, const char* what,
                           const char* option, const char* without);

/// Fills the pixels of a plane over a window that its files lack with values that change nothing: AO 1 of materials, no
/// object of a matte. All other planes keep their 0.
void fill_missing(const FrameSource& source, const Window& window, RawPlane plane, std::span<float> values);

}  // namespace alcove
