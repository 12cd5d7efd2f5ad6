// Finds the AOVs of a frame in its files and describes them completely; the only code that knows renderers' names.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/formats/exr.h"
#include "core/frame/camera.h"
#include "core/frame/channels.h"
#include "core/frame/depth.h"
#include "core/frame/input_rules.h"

namespace alcove {

/// Something that neither settings nor camera say.
struct Guess {
  std::string what, chosen, why, option;  // option: what says it
};

/// Where everything is that a frame needs; nothing but headers has been read.
struct FrameSource {
  std::vector<ExrFile> files;
  Window data, display;  // of all channels below; data may be a part of what the files hold, then no more is read
  Window file_data;      // what the files hold
  std::optional<Window> region;  // what is to be written of it; none: all of data
  bool settled = false;          // see core/frame/settle.h
  double depth_step = 0;         // see step_of()
  bool has_evidence = true;      // false: its pixels did not show what was left open
  double pixel_aspect = 1;
  std::vector<ChannelRef> depth;     // one, or x, y, z of positions
  std::vector<ChannelRef> normal;    // x, y, z, or two of them; none: to be reconstructed from depth
  std::vector<ChannelRef> beauty;    // r, g, b and, where there is one, a; none unless asked for
  std::vector<ChannelRef> indirect;  // r, g, b: the indirect diffuse light; none where the frame has no such part
  // r, g, b: the colour that it is still to be multiplied by; none where it holds it already
  std::vector<ChannelRef> diffuse_color;
  std::vector<ChannelRef> material_ao;  // one; none unless the settings name it
  std::vector<ChannelRef> albedo;       // r, g, b: the diffuse colour; none unless asked for
  DepthKind depth_kind = DepthKind::planar;
  DepthRange depth_range;
  PositionSpace position_space = PositionSpace::world;
  NormalSpace normal_space = NormalSpace::world;
  NormalEncoding normal_encoding = NormalEncoding::signed_float;
  bool normal_unorm = false;  // the values are 0.5 + 0.5 n, of any encoding
  NormalFlips flip_normal;
  const InputRules* rules = nullptr;  // of the program that wrote the frame
  std::string rules_by;               // the attribute or channel, or the option, that told; empty: nothing did
  bool rules_said = false;            // by an option: what they say is no guess
  DepthKind usual_depth_kind = DepthKind::planar;  // by the rules, for what is open
  NormalSpace usual_normal_space = NormalSpace::world;
  // nobody says it; the pixels decide
  bool depth_kind_open = false, normal_space_open = false, normal_encoding_open = false;
  Camera camera;
  std::string camera_from;  // the attributes that gave it; empty: the settings did
  std::vector<Guess> guesses;
  // what the user should know: guesses that are unusual, options that the pixels speak against; a sentence each
  std::vector<std::string> notes;
  std::vector<std::string> suspicious;  // what harms AO
};

/// Opens the files that the settings name and finds the channels. `with_beauty` asks for the beauty and its ambient
/// parts too, `with_albedo` for the diffuse colour.
/// Fails with ErrorKind::input, listing what there is and naming the option that decides, when a channel is not found,
/// is found twice, is subsampled, or has another size than the depth.
FrameSource find_frame(const InputSettings& settings, bool with_beauty, int frame, bool with_albedo = false);

/// Whether the header of the frame's depth or position file has a camera. Fails as opening it does.
bool header_has_camera(const InputSettings& settings);

/// A plane, or several one behind the other, and where it goes.
struct PlaneRead {
  const std::vector<ChannelRef>* channels;
  float* to;
};

/// Reads all planes within source.data, every part of every file decoded once.
void read_planes(FrameSource& source, const std::vector<PlaneRead>& reads);

}  // namespace alcove
