// Tells a picture of colours, normals or positions from depth, where the depth channel is one of three.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/error.h"
#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/frame/linear_fit.h"

namespace alcove {
namespace {

constexpr int kColourRows = 24;       // of the picture that are looked at
constexpr double kGrey = 0.02;        // relative difference of R, G and B that lossy compression makes of grey
constexpr double kDark = 0.01;        // of the median, below which noise is no colour
constexpr double kColoured = 0.005;   // share of the pixels from which a picture is no grey one
constexpr double kUnitLength = 0.05;  // of a length that is taken for 1
constexpr double kAreNormals = 0.95;  // share of unit vectors

/// A channel and the two that make a colour or a vector of it.
using Three = std::array<ChannelRef, 3>;

std::optional<Three> three_of(const ChannelSearch& search, const ChannelRef& depth, const char* second,
                              const char* third) {
  const auto other = search.beside(depth, second), last = search.beside(depth, third);
  return other && last ? std::optional<Three>({depth, *other, *last}) : std::nullopt;
}

std::string last_word(const std::string& channel) { return lower_case(channel.substr(channel.rfind('.') + 1)); }

/// The values of some rows.
std::array<std::vector<float>, 3> sample_of(FrameSource& source, const Three& three) {
  const Window& data = source.part_of(three[0]).data;
  const int rows = std::min(kColourRows, data.height);
  const auto width = std::size_t(data.width);
  std::array<std::vector<float>, 3> planes;
  for (auto& plane : planes) plane.resize(std::size_t(rows) * width);
  for (int i = 0; i < rows; i++) {
    std::vector<ExrRead> reads;
    for (std::size_t c = 0; c < 3; c++)
      reads.push_back({three[c].part, three[c].channel, planes[c].data() + std::size_t(i) * width});
    source.files[three[0].file].read(reads, int((std::int64_t(2 * i + 1) * data.height) / (2 * rows)), 1);
  }
  return planes;
}

bool varies(const std::vector<float>& plane) {
  return std::ranges::any_of(plane, [&](float value) { return value != plane.front(); });
}

/// Whether the second and the third channel are there for more than to be equal to the first.
bool are_colours(const std::array<std::vector<float>, 3>& planes) {
  if (!varies(planes[1]) && !varies(planes[2])) return false;
  std::vector<double> sizes;
  for (const float value : planes[0])
    if (std::isfinite(value) && value != 0) sizes.push_back(std::abs(value));
  const double dark = sizes.empty() ? 0 : kDark * median_of(std::move(sizes));
  std::size_t pixels = 0, coloured = 0;
  for (std::size_t i = 0; i < planes[0].size(); i++) {
    const std::array<double, 3> c{planes[0][i], planes[1][i], planes[2][i]};
    if (!std::ranges::all_of(c, [](double value) { return std::isfinite(value); })) continue;
    const auto [least, most] = std::ranges::minmax(c);
    pixels++;
    coloured += most - least > kGrey * std::max({std::abs(least), std::abs(most), dark});
  }
  return double(coloured) > kColoured * double(pixels);
}

bool are_normals(const std::array<std::vector<float>, 3>& planes) {
  std::size_t vectors = 0, units = 0;
  for (std::size_t i = 0; i < planes[0].size(); i++) {
    const double length = std::hypot(planes[0][i], planes[1][i], planes[2][i]);
    vectors += length > 0;
    units += std::abs(length - 1) < kUnitLength;
  }
  return vectors > 0 && double(units) > kAreNormals * double(vectors);
}

}  // namespace

void doubt_depth_of_three(FrameSource& source, const ChannelSearch& search, const ChannelRef& depth) {
  const std::string word = last_word(depth.channel), path = source.files[depth.file].path();
  const std::string layer = depth.channel.substr(0, depth.channel.size() - word.size());
  if (word == "y" && search.has(depth, "ry") && search.has(depth, "by"))
    fail(ErrorKind::input,
         "{}: {}Y with RY and BY is the brightness of a picture of colours, and no depth: give the file of the depth "
         "with --depth, or name its channel with --depth-channel",
         path, layer);
  const bool is_vector = word == "z";
  auto three = is_vector       ? three_of(search, depth, "x", "y")
               : word == "red" ? three_of(search, depth, "green", "blue")
               : word == "r"   ? three_of(search, depth, "g", "b")
                               : std::nullopt;
  if (!three) return;
  const auto planes = sample_of(source, *three);
  if (is_vector && are_normals(planes))
    fail(
        ErrorKind::input,
        "{}: {}X, Y and Z are vectors of length 1, which are normals and no depth: give the file to --normal, and that "
        "of the depth to --depth; --depth-channel {} takes Z as depth",
        path, layer, depth.channel);
  if (is_vector) {
    source.suspicious.push_back(
        {NoteCode::said_otherwise,
         fmt::format("{} is taken as depth, and stands beside X and Y: where the three are positions, give the file to "
                     "--position instead; --depth-channel {} says that it is depth",
                     depth.channel, depth.channel)});
    return;
  }
  if (!are_colours(planes)) return;
  const std::string text = fmt::format(
      "R, G and B of {} differ, as in a picture of colours, normals or positions, and not as in one of depth: give "
      "the file of the depth with --depth, or name its channel with --depth-channel; --position takes positions; "
      "--depth-channel {} takes this one as depth",
      layer.empty() ? "the file" : "layer " + layer.substr(0, layer.size() - 1), depth.channel);
  if (layer.empty()) fail(ErrorKind::input, "{}: {}", path, text);
  source.suspicious.push_back({NoteCode::said_otherwise, text});
}

}  // namespace alcove
