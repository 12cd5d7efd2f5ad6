// Finding the planes behind the first surface.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/behind.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/base/text.h"
#include "core/frame/header_camera.h"
#include "core/frame/plane_windows.h"
#include "core/frame/views.h"

namespace alcove {
namespace {

const AovNames& behind_names() {
  static const AovNames names = [] {
    AovNames depth = kDepthNames;
    depth.channel_option = "--set behind-channel";
    return depth;
  }();
  return names;
}

const ExrFile& file_of(const FrameSource& source, const ChannelRef& ref) { return source.files[ref.file]; }

/// What is said of all files once, or of each.
template <class T>
T said_of(const std::vector<T>& all, std::size_t file, T otherwise) {
  if (all.empty()) return otherwise;
  return all.size() == 1 ? all.front() : all[file];
}

/// The pixels of a plane are those of the depth.
void require_same_pixels(const FrameSource& source, const ChannelRef& ref) {
  const ChannelRef& depth = source[RawPlane::depth][0];
  const ExrFile &file = file_of(source, ref), &own = file_of(source, depth);
  if (file.display() != source.display)
    fail(ErrorKind::input,
         "{}: its display window is {}, and that of the depth in {} is {}: both must show the same pixels (--behind)",
         file.path(), to_string(file.display()), own.path(), to_string(source.display));
  require_same_picture(source, {ref}, "depth", "--behind");
  const std::string theirs = view_in(file, source.view), ours = view_in(own, source.view);
  if (!theirs.empty() && !ours.empty() && !same_name(theirs, ours))
    fail(ErrorKind::input,
         "{}: its view is {}, and that of the depth in {} is {}: give the same of both (--behind, "
         "--view)",
         file.path(), theirs, own.path(), ours);
}

bool is_half(const FrameSource& source, const ChannelRef& ref) {
  const auto& channels = source.part_of(ref).channels;
  const auto channel = std::ranges::find(channels, ref.channel, &ExrChannel::name);
  return channel != channels.end() && channel->type == SampleType::half_float;
}

bool is_near(double a, double b) {
  constexpr double kSame = 1e-3;  // attributes are rounded
  return std::abs(a - b) <= kSame * std::max({1.0, std::abs(a), std::abs(b)});
}

bool is_same_camera(const Camera& a, const Camera& b) {
  if (!is_near(a.fx, b.fx) || !is_near(a.fy, b.fy) || !is_near(a.cx, b.cx) || !is_near(a.cy, b.cy)) return false;
  if (!a.view_from_world || !b.view_from_world) return true;
  for (std::size_t row = 0; row < 3; row++) {
    if (!is_near(a.view_from_world_offset[row], b.view_from_world_offset[row])) return false;
    for (std::size_t column = 0; column < 3; column++)
      if (!is_near((*a.view_from_world)[row][column], (*b.view_from_world)[row][column])) return false;
  }
  return true;
}

/// Notes a header whose camera is not that of the depth's header: it may be of another frame.
void note_other_camera(FrameSource& source, const ChannelRef& ref) {
  const auto camera_of = [&](const ChannelRef& channel) {
    const ExrFile& file = file_of(source, channel);
    return header_camera(file.attribute_texts(channel.part), source.display, source.file_data, source.pixel_aspect,
                         source.layer_of(channel));
  };
  const auto theirs = camera_of(ref), ours = camera_of(source[RawPlane::depth][0]);
  if (theirs && ours && !is_same_camera(theirs->camera, ours->camera))
    source.notes.push_back({NoteCode::said_otherwise,
                            fmt::format("the camera in the header of {} is another than that in the header of {}: are "
                                        "they of the same frame (--behind)?",
                                        file_of(source, ref).path(), source.depth_path())});
}

/// The one channel of a file.
ChannelRef find_channel(FrameSource& source, ChannelSearch& search, std::size_t file, const std::string& chosen) {
  const ChannelRef& depth = source[RawPlane::depth][0];
  const bool is_alone = file != depth.file;
  auto found = search.find_by_rules(file, behind_names(), chosen, source.rules->depth).channels;
  if (found.empty()) found = search.require(file, behind_names(), chosen, is_alone, "Z");
  if (found[0] == depth)
    fail(ErrorKind::input,
         "{}: {} is the depth of the frame itself: name what lies behind it with --set behind-channel, "
         "or another file with --behind",
         source.files[file].path(), found[0].channel);
  return found[0];
}

std::string base_name(const FrameSource& source, const ChannelRef& ref) {
  return std::filesystem::path(file_of(source, ref).path()).filename().string();
}

}  // namespace

void find_behind(FrameSource& source, ChannelSearch& search, const InputSettings& settings) {
  std::size_t number = 0;
  for (const auto& path : settings.behind) {
    if (path.empty()) continue;
    const std::size_t file = search.open(path, "--behind");
    const ChannelRef ref =
        find_channel(source, search, file, said_of<std::string>(settings.behind_channels, number, ""));
    require_same_pixels(source, ref);
    if (ref.file != source[RawPlane::depth][0].file) note_other_camera(source, ref);
    const BehindKind kind = said_of(settings.behind_kinds, number, BehindKind::surfaces);
    source[RawPlane::behind].push_back(ref);
    source.behind.push_back({.kind = kind, .is_half = is_half(source, ref)});
    if (source.behind.back().is_half && !source.depth_is_half)
      source.suspicious.push_back(
          {NoteCode::half_depth, fmt::format("{} of {} is stored as half float, and the depth is not: what lies behind "
                                             "is off by up to a 2048th of its depth; write it as float",
                                             ref.channel, path)});
    number++;
  }
}

std::string hidden_sources_text(const FrameSource& source) {
  std::vector<std::string> sources;
  for (std::size_t i = 0; i < source[RawPlane::behind].size(); i++) {
    const ChannelRef& ref = source[RawPlane::behind][i];
    sources.push_back(fmt::format("{} {} {}", base_name(source, ref), ref.channel, word_of(source.behind[i].kind)));
  }
  std::ranges::sort(sources);
  return fmt::format("{}", fmt::join(sources, "; "));
}

}  // namespace alcove
