// Holds motion vectors against where the cameras alone would move what is seen.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/motion.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/frame/find/channels.h"
#include "core/frame/samples.h"

namespace alcove {
namespace {

/// px: the vector of a surface that stands still may be off by it, and by this part of the way, since vectors are
/// often stored as half floats.
constexpr double kStill = 0.1, kStillPart = 0x1p-10;
/// The least share of surfaces that agree with the cameras by the right reading: the others may all move.
constexpr double kLeastShare = 0.05;

const AovNames kMotionNames{
    .what = "motion vectors",
    .channel_option = "--set motion-channels",
    .layers = {"vector", "motion", "motionvector", "motionvectors", "motion_vector", "motion_vectors", "velocity", "mv",
               "motion2d"},
    .in_layer = {{"x", "y"}, {"r", "g"}, {"u", "v"}, {"red", "green"}},
    .bare = {{"u", "v"}},
    .alone = {{"x", "y"}, {"r", "g"}, {"u", "v"}, {"red", "green"}},
};

/// The second pair of those who write both ways, Blender's first of all: of a layer, where the settings name one.
AovNames second_pair(const std::string& layer) {
  AovNames names = kMotionNames;
  if (!layer.empty()) names.layers = {lower_case(layer)};
  names.in_layer = {{"z", "w"}, {"b", "a"}};
  names.bare.clear();
  names.alone = names.in_layer;
  return names;
}

using Pixels = std::array<double, 2>;

/// The step, px, of a pixel's surface in the picture if it stands still; nothing behind the other camera.
std::optional<Pixels> by_cameras(const View& view, const FromThere& there, std::size_t pixel, float depth) {
  const double px = double(pixel % std::size_t(view.size.x)) + 0.5, py = double(pixel / std::size_t(view.size.x)) + 0.5;
  const SeenAt seen = seen_from(there.view, there.map, view, px, py, depth);
  if (!there.view.orthographic && seen.depth <= 0) return std::nullopt;
  return Pixels{seen.x - px, seen.y - py};
}

bool is_still(const Pixels& by_cameras, double x, double y) {
  const double off = std::hypot(x - by_cameras[0], y - by_cameras[1]);
  return off < kStill + kStillPart * std::hypot(by_cameras[0], by_cameras[1]);  // false for NaN
}

const std::optional<FromThere>& frame_of(const MotionFrame& frame, MotionKind kind) {
  return kind == MotionKind::previous ? frame.previous : frame.next;
}

/// All ways in which a pair of channels may hold the way to a frame.
std::vector<MotionReading> readings_of(std::size_t pair, MotionKind kind, const View& view) {
  std::vector<MotionReading> readings;
  const double width = view.size.x, height = view.size.y;
  for (const Pixels unit : {Pixels{1, 1}, Pixels{width, height}, Pixels{width / 2, height / 2}})
    for (const double sign : {1., -1.})
      for (const double up : {-1., 1.}) readings.push_back({pair, kind, {sign * unit[0], sign * up * unit[1]}});
  return readings;
}

/// Fills in the share of the readings of one pair that lead to one frame.
void judge(std::span<MotionReading> readings, const MotionPlanes::Pair& pair, const MotionFrame& frame,
           const FromThere& there) {
  std::size_t surfaces = 0;
  for (std::size_t i = 0; i < frame.depth.size(); i += kSparse) {
    if (frame.depth[i] >= kSkyDepth) continue;
    const auto expected = by_cameras(frame.view, there, i, frame.depth[i]);
    if (!expected) continue;
    surfaces++;
    for (auto& reading : readings)
      reading.share += is_still(*expected, reading.scale[0] * double(pair.x[i]), reading.scale[1] * double(pair.y[i]));
  }
  for (auto& reading : readings) reading.share /= double(std::max<std::size_t>(surfaces, 1));
}

}  // namespace

MotionPlanes read_motion(const InputSettings& settings, const Window& data) {
  std::vector<ExrFile> files;
  ChannelSearch search(settings, files);
  const std::size_t file = search.open(settings.motion, "--motion");
  std::vector<std::vector<ChannelRef>> pairs{
      search.require(file, kMotionNames, settings.motion_channels, true, "Vector.X")};
  if (settings.motion_channels.find(',') == std::string::npos)
    if (auto second = search.find(file, second_pair(settings.motion_channels), "", true); !second.empty())
      pairs.push_back(std::move(second));
  MotionPlanes planes{files[file].path(), {}};
  std::vector<ExrRead> reads;
  planes.pairs.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); i++)
    for (std::size_t c = 0; c < 2; c++) {
      const ChannelRef& channel = pairs[i][c];
      const Window& window = files[file].parts()[std::size_t(channel.part)].data;
      if (window != data)
        fail(ErrorKind::input,
             "{}: the motion vectors {} are {}, and the depth is {}: both must cover the same pixels "
             "(--motion)",
             planes.path, channel.channel, to_string(window), to_string(data));
      auto& plane = c == 0 ? planes.pairs[i].x : planes.pairs[i].y;
      plane.resize(data.pixels());
      reads.push_back({channel.part, channel.channel, plane.data()});
    }
  files[file].read(reads);
  return planes;
}

std::optional<MotionReading> best_motion_reading(const MotionPlanes& planes, const MotionFrame& frame,
                                                 MotionKind kind) {
  std::optional<MotionReading> best;
  for (std::size_t pair = 0; pair < planes.pairs.size(); pair++)
    for (const MotionKind way : {MotionKind::previous, MotionKind::next}) {
      const auto& there = frame_of(frame, way);
      if (!there || (kind != MotionKind::automatic && kind != way)) continue;
      std::vector<MotionReading> readings = readings_of(pair, way, frame.view);
      judge(readings, planes.pairs[pair], frame, *there);
      for (const auto& reading : readings)
        if (!best || reading.share > best->share) best = reading;
    }
  return best && best->share >= kLeastShare ? best : std::nullopt;
}

std::vector<std::uint8_t> moving_by(const MotionPlanes& planes, const MotionReading& reading, const MotionFrame& frame,
                                    int around) {
  const MotionPlanes::Pair& pair = planes.pairs[reading.pair];
  const FromThere& there = frame_of(frame, reading.kind).value();
  const int width = frame.view.size.x, height = frame.view.size.y;
  std::vector<std::uint8_t> moving(frame.depth.size());
  for (std::size_t i = 0; i < frame.depth.size(); i++) {
    if (frame.depth[i] >= kSkyDepth) continue;
    const auto expected = by_cameras(frame.view, there, i, frame.depth[i]);
    if (expected && is_still(*expected, reading.scale[0] * double(pair.x[i]), reading.scale[1] * double(pair.y[i])))
      continue;
    const int x = int(i % std::size_t(width)), y = int(i / std::size_t(width));
    for (int v = std::max(y - around, 0); v <= std::min(y + around, height - 1); v++)
      for (int u = std::max(x - around, 0); u <= std::min(x + around, width - 1); u++)
        moving[std::size_t(v) * std::size_t(width) + std::size_t(u)] = 1;
  }
  return moving;
}

}  // namespace alcove
