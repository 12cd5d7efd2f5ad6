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

/// FrameSource::camera_from where the pass of positions gave it.
inline constexpr const char* kByPositions = "its positions";

/// Where everything is that a frame needs, and how it is read; nothing but headers has been read. `data` may be a part
/// of what the files hold, then no more is read.
struct FrameSource : Reading {
  /// The channels of a plane, in the order of its components; none: the frame has no such plane, or nobody asked for
  /// it. The indirect diffuse light is to be multiplied by the diffuse colour where that is there, and holds it already
  /// where it is not.
  std::vector<ChannelRef>& operator[](RawPlane plane) { return planes[plane]; }
  const std::vector<ChannelRef>& operator[](RawPlane plane) const { return planes[plane]; }
  /// The file of the depth or the positions, after which the frame is called in messages.
  const std::string& depth_path() const { return files[planes[RawPlane::depth][0].file].path(); }
  /// The file of the normals for notes on them: "" where it is the frame's own, or where there are none.
  std::string normal_file() const {
    const auto& normal = planes[RawPlane::normal];
    return normal.empty() || normal[0].file == planes[RawPlane::depth][0].file ? "" : files[normal[0].file].path();
  }
  /// The part of a file that a channel lies in.
  const ExrPart& part_of(const ChannelRef& ref) const { return files[ref.file].parts()[std::size_t(ref.part)]; }
  /// Whether its samples are half floats.
  bool is_half(const ChannelRef& ref) const;
  /// The name of a channel without its last part, which a part's name stands for; "" where it has no layer.
  std::string layer_of(const ChannelRef& ref) const;

  std::vector<ExrFile> files;
  std::optional<std::size_t> deep;  // of them, whose samples are the depth, or give planes behind it
  std::vector<int> deep_parts;      // of that file
  // of other files and their parts, whose samples count together with those
  std::vector<std::pair<std::size_t, std::vector<int>>> deep_elements;
  Window deep_data;                 // over which samples are read
  bool deep_depth_is_half = false;  // samples are the depth, and were rounded to half floats
  RawPlaneArray<std::vector<ChannelRef>> planes;
  std::vector<ChannelRef> positions;     // that may tell the camera; none where there are none
  Window file_data;                      // what the files hold
  std::optional<Window> region;          // what is to be written of it; none: all of data
  std::uint64_t rows_read = 0;           // that were decoded, each as often as it was
  bool settled = false;                  // see core/frame/settle.h
  bool has_evidence = true;              // false: its pixels did not show what was left open
  Grain grain;                           // of the depth's values
  std::vector<DepthScore> depth_scores;  // of depth that is no position
  // of the surfaces, scene units; none until the frame is settled, and where all is sky
  std::optional<double> median_depth;
  const InputRules* rules = nullptr;  // of the program that wrote the frame
  std::string rules_by;               // the attribute or channel, or the option, that told; empty: nothing did
  bool rules_said = false;            // an option names them: what they say is no guess
  DepthKind usual_depth_kind = DepthKind::planar;  // by the rules, for what is open
  NormalSpace usual_normal_space = NormalSpace::world;
  // Nobody says it, so the pixels decide.
  bool depth_kind_open = false, normal_space_open = false, normal_encoding_open = false;
  bool normals_left_out = false;  // the settings say so
  std::string view;               // that is read, of files with views
  std::string camera_from;        // what of the frame gave it; empty: the settings did
  // Nobody gave a camera, and this one only stands in for it, so that the pixels cannot speak against it.
  bool camera_is_assumed = false;
  std::vector<Guess> guesses;
  // what the user should know, a sentence each: guesses that are unusual, options that the pixels speak against
  Notes notes;
  Notes suspicious;  // what harms AO
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

/// Reads planes within source.data, which is as wide as the files. Every part of every file is decoded once.
void read_planes(FrameSource& source, const std::vector<PlaneRead>& reads);

/// Depth and normals over source.data, as they were read.
struct RawFrame {
  std::vector<float> depth, normal;
};
RawFrame read_raw_frame(FrameSource& source);

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

/// Puts what changes nothing into the pixels of a plane over source.data that its files do not have: AO 1 of materials,
/// no object of a matte. Of all other planes that is the 0 that is there.
void fill_missing(const FrameSource& source, RawPlane plane, std::span<float> values);

}  // namespace alcove
