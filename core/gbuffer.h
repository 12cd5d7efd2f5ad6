// Finds the AOVs of a frame in its files and describes them completely; the only code that knows renderers' names.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/depth.h"
#include "core/exr.h"
#include "core/settings.h"

namespace alcove {

/// One channel of one of the frame's files.
struct ChannelRef {
  std::size_t file;
  int part;
  std::string channel;
  auto operator<=>(const ChannelRef&) const = default;
};

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
  bool settled = false;  // see core/settle.h
  bool has_evidence = true;  // false: its pixels did not show what was left open
  double pixel_aspect = 1;
  std::vector<ChannelRef> depth;          // one, or x, y, z of positions
  std::vector<ChannelRef> normal;         // x, y, z, or two of them; none: to be reconstructed from depth
  std::vector<ChannelRef> beauty;         // r, g, b and, where there is one, a; none unless asked for
  std::vector<ChannelRef> indirect;       // r, g, b: the indirect diffuse light; none where the frame has no such part
  std::vector<ChannelRef> diffuse_color;  // r, g, b: the colour that it is still to be multiplied by; none where it holds it already
  std::vector<ChannelRef> material_ao;    // one; none unless the settings name it
  std::vector<ChannelRef> albedo;         // r, g, b: the diffuse colour; none unless asked for
  DepthKind depth_kind = DepthKind::planar;
  DepthRange depth_range;
  PositionSpace position_space = PositionSpace::world;
  NormalSpace normal_space = NormalSpace::world;
  NormalEncoding normal_encoding = NormalEncoding::signed_float;
  bool normal_unorm = false;  // the values are 0.5 + 0.5 n, of any encoding
  NormalFlips flip_normal;
  Camera camera;
  std::vector<Guess> guesses;
  std::vector<std::string> notes;  // what the user should know: guesses that are unusual, and what harms; a sentence each
};

/// Opens the files that the settings name and finds the channels. `with_beauty` asks for the beauty and its ambient parts too, `with_albedo` for the
/// diffuse colour.
/// Fails with ErrorKind::input, listing what there is and naming the option that decides, when a channel is not found, is
/// found twice, is subsampled, or has another size than the depth.
FrameSource find_frame(const InputSettings& settings, bool with_beauty, int frame, bool with_albedo = false);

/// A plane, or several one behind the other, and where it goes.
struct PlaneRead {
  const std::vector<ChannelRef>* channels;
  float* to;
};

/// Reads all planes within source.data, every part of every file decoded once.
void read_planes(FrameSource& source, const std::vector<PlaneRead>& reads);

}  // namespace alcove
