// Looks at pixels and headers for what harms AO.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/findings.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/frame/evidence.h"
#include "core/frame/settle.h"

namespace alcove {
namespace {

constexpr double kStep = 0.1;     // relative change of depth that is an edge
constexpr double kSmooth = 0.02;  // relative change within a surface
constexpr double kBetween = 0.1;  // part of a step within which a value belongs to the surface on that side
constexpr int kLeastEdges = 100;
constexpr double kMostBlended = 0.3;     // of the edges; thin things give some by themselves
constexpr double kMostShortened = 0.02;  // of the normals

/// DWA quantizes channels by the last part of their names.
bool is_lossy(const FrameSource& source, const ChannelRef& ref) {
  static const std::set<std::string> kNames{"r", "g", "b", "y", "ry", "by"};
  const std::size_t dot = ref.channel.rfind('.');
  const std::string last = lower_case(dot == ref.channel.npos ? ref.channel : ref.channel.substr(dot + 1));
  return source.files[ref.file].parts()[std::size_t(ref.part)].dwa && kNames.contains(last);
}

/// Parts whose first or last rows cannot be read: of a file that was cut short, where the frame's own parts stand
/// before the cut.
std::vector<std::string> cut_parts(ExrFile& file) {
  std::vector<std::string> found;
  for (std::size_t p = 0; p < file.parts().size(); p++) {
    const ExrPart& part = file.parts()[p];
    const auto channel = std::ranges::find(part.channels, false, &ExrChannel::subsampled);
    if (channel == part.channels.end()) continue;
    std::vector<float> row(std::size_t(part.data.width));
    const ExrRead read{int(p), channel->name, row.data()};
    try {
      for (const int y : {0, part.data.height - 1}) file.read({&read, 1}, y, 1);
    } catch (const Error& error) {
      found.push_back(error.what());
    }
  }
  return found;
}

}  // namespace

bool has_lengths(const FrameSource& source) {
  return source[RawPlane::normal].size() == 3 &&
         (source.normal_encoding == NormalEncoding::signed_float || source.normal_encoding == NormalEncoding::unorm);
}

double blended_edges(std::span<const float> planar, int width) {
  int sharp = 0, blended = 0;
  const auto close = [](double a, double b) { return std::abs(a - b) < kSmooth * std::min(a, b); };
  for (std::size_t row = 0; row + std::size_t(width) <= planar.size(); row += std::size_t(width))
    for (int x = 2; x + 2 < width; x++) {
      const float* z = &planar[row + std::size_t(x)];
      if (std::any_of(z - 2, z + 3, [](float v) { return std::isinf(v); })) continue;
      const double before = z[-1], here = z[0], after = z[1];
      if (!close(z[-2], before) || !close(after, z[2]) || std::abs(after - before) < kStep * std::min(before, after))
        continue;
      const double place = (here - before) / (after - before);
      if (place > kBetween && place < 1 - kBetween) blended++;
      // An edge without a pixel in between is seen from both of its sides, and is counted once.
      else if (place <= kBetween)
        sharp++;
    }
  return sharp + blended < kLeastEdges ? 0 : double(blended) / (sharp + blended);
}

std::vector<std::string> findings(FrameSource& source, std::span<const float> depth, std::span<const float> normal) {
  std::vector<std::string> found;
  const DepthMap map = depth_map_of(source);
  const double blended =
      blended_edges(planar_depths(depth, map, view_of(source.camera, source.data, source.display)), source.data.width);
  if (blended > kMostBlended)
    found.push_back(
        fmt::format("{:.0f} % of the depth's edges have a pixel in between: the depth is anti-aliased, and AO shows "
                    "seams there; render it without filtering",
                    100 * blended));
  if (has_lengths(source)) {
    const NormalStatistics s = normal_statistics(normal, depth, map);
    const double unit = source.normal_unorm ? s.unorm_unit_share : s.unit_share;
    if (s.count && unit < 1 - kMostShortened)
      found.push_back(
          fmt::format("{:.0f} % of the normals are not of unit length: they were averaged over the pixel, at edges "
                      "over several surfaces",
                      100 * (1 - unit)));
  }
  for (const auto* channels : {&source[RawPlane::depth], &source[RawPlane::normal]})
    for (const auto& channel : *channels)
      if (is_lossy(source, channel))
        found.push_back(
            fmt::format("{} is compressed by DWA, which is lossy for a channel of that name; write data with zip",
                        channel.channel));
  for (auto& file : source.files)
    for (auto& sentence : cut_parts(file)) found.push_back(std::move(sentence));
  const std::size_t file = source[RawPlane::depth][0].file;
  for (const auto& part : source.files[file].parts())
    if (part.data != source.file_data) {
      found.push_back(fmt::format("part {} is {}, and the depth is {}", part.name, to_string(part.data),
                                  to_string(source.file_data)));
      break;
    }
  if (source.file_data != source.display)
    found.push_back(
        fmt::format("the data window is {} and the display window {}: AO is computed on the data window, and the "
                    "camera is for the display window",
                    to_string(source.file_data), to_string(source.display)));
  return found;
}

}  // namespace alcove
