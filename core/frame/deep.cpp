// Finding deep parts, and telling the kind of their depth by the flat one.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/deep.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text.h"

namespace alcove {
namespace {

constexpr double kPrecisions = 4;            // surfaces are one within so many times what a depth may be off
constexpr double kLeastPrecision = 0x1p-16;  // of the depth, see depth_precision()
constexpr int kEvidenceRows = 64;            // of the frame, by which the kind of samples is settled
constexpr double kWhole = 0.5;               // share of the surfaces with another one behind
constexpr std::size_t kLeastPixels = 64;     // fewer tell too little
constexpr double kLeastSame = 0.1;           // share of the pixels whose first surface must be the depth's

bool has_channel(const ExrPart& part, const char* name) {
  return std::ranges::find(part.channels, name, &ExrChannel::name) != part.channels.end();
}

bool is_half(const ExrFile& file, const std::vector<int>& parts) {
  return std::ranges::any_of(parts, [&](int part) {
    const auto& channels = file.parts()[std::size_t(part)].channels;
    const auto z = std::ranges::find(channels, "Z", &ExrChannel::name);
    return z != channels.end() && z->type == SampleType::half_float;
  });
}

/// Takes a file's samples for the frame.
void choose(FrameSource& source, std::size_t file, const InputSettings& settings) {
  source.deep = file;
  source.deep_parts = deep_parts_of(source.files[file], settings);
}

/// Whether samples go on behind the first surface: those of a renderer end there, however much is hidden. Rows all over
/// the file tell, so that each part of a frame has the answer of the whole.
bool goes_on_behind(ExrFile& file, int part, const Window& data) {
  const auto width = std::size_t(data.width);
  std::vector<float> first(width), second(width);
  const std::array reads{ExrRead{part, deep_channel(0, false), first.data()},
                         ExrRead{part, deep_channel(1, false), second.data()}};
  std::size_t surfaces = 0, more = 0;
  const int rows = std::min(kEvidenceRows, data.height);
  for (int i = 0; i < rows; i++) {
    file.read(reads, int((std::int64_t(2 * i + 1) * data.height) / (2 * rows)), 1);
    const auto is_surface = [](float z) { return z < kNoDeepSurface; };
    surfaces += std::size_t(std::ranges::count_if(first, is_surface));
    more += std::size_t(std::ranges::count_if(second, is_surface));
  }
  return surfaces > 0 && double(more) >= kWhole * double(surfaces);
}

/// One way to read the depth of samples.
struct DeepReading {
  DepthKind kind;
  double scale;
  std::size_t same = 0;  // pixels whose first surface is the depth's
};

}  // namespace

std::vector<int> deep_parts_of(const ExrFile& file, const InputSettings& settings) {
  const auto views = views_of(file);
  const std::string view = lower_case(settings.view.empty() && !views.empty() ? views.front() : settings.view);
  std::vector<int> of_view, of_layer;
  for (std::size_t i = 0; i < file.parts().size(); i++) {
    const ExrPart& part = file.parts()[i];
    if (!part.deep || (!part.view.empty() && lower_case(part.view) != view)) continue;
    of_view.push_back(int(i));
    if (!settings.layer.empty() && lower_case(part.name) == lower_case(settings.layer)) of_layer.push_back(int(i));
  }
  return of_layer.empty() ? of_view : of_layer;
}

bool is_all_deep(const ExrFile& file) {
  return std::ranges::all_of(file.parts(), [](const ExrPart& part) { return part.deep.has_value(); });
}

std::vector<ChannelRef> find_deep_depth(FrameSource& source, ChannelSearch& search, std::size_t depth_file,
                                        const InputSettings& settings) {
  if (!settings.depth_channel.empty()) return {};
  if (is_all_deep(source.files[depth_file])) {
    choose(source, depth_file, settings);
    if (!settings.deep.empty() && settings.deep != source.files[depth_file].path())
      fail(ErrorKind::input, "{}: it is deep, and so is {}: give one of them, or a flat depth (--deep)",
           source.files[depth_file].path(), settings.deep);
  } else {
    if (settings.deep.empty() || !settings.depth.empty() || !search.find(depth_file, kDepthNames, "", false).empty() ||
        search.find_by_rules(depth_file, kDepthNames, "", source.rules->depth).candidate)
      return {};
    choose(source, search.open(settings.deep, "--deep"), settings);
  }
  if (source.deep_parts.empty()) {
    source.deep.reset();
    return {};
  }
  source.deep_depth_is_half = is_half(source.files[*source.deep], source.deep_parts);
  return {{*source.deep, source.deep_parts.front(), deep_channel(0, false)}};
}

void find_deep(FrameSource& source, ChannelSearch& search, const InputSettings& settings) {
  const bool is_depth = source.deep.has_value();
  if (!is_depth && settings.deep.empty()) return;
  if (!is_depth) choose(source, search.open(settings.deep, "--deep"), settings);
  const ExrFile& file = source.files[*source.deep];
  if (source.deep_parts.empty())
    fail(ErrorKind::input, "{}: it holds no deep data{}; --behind takes flat depth (--deep)", file.path(),
         settings.view.empty() ? "" : fmt::format(" of the view {}", settings.view));
  const int first = source.deep_parts.front();
  const Window& data = file.parts()[std::size_t(first)].data;
  if (data != source.file_data || file.display() != source.display)
    fail(ErrorKind::input,
         "{}: its deep samples are {} of {}, and the depth of {} is {} of {}: both must cover the same pixels (--deep)",
         file.path(), to_string(data), to_string(file.display()), source.depth_path(), to_string(source.file_data),
         to_string(source.display));
  const bool half = is_half(file, source.deep_parts);
  const bool has_backs = std::ranges::any_of(
      source.deep_parts, [&](int part) { return has_channel(file.parts()[std::size_t(part)], "ZBack"); });
  const auto add = [&](std::size_t surface, bool back) {
    source[RawPlane::behind].push_back({*source.deep, first, deep_channel(surface, back)});
    source.behind.push_back(
        {.kind = back ? BehindKind::backs : BehindKind::surfaces, .is_half = half, .is_whole = false});
  };
  for (std::size_t surface = is_depth ? 1 : 0; surface < kMostDeepSurfaces; surface++) add(surface, false);
  for (std::size_t surface = 0; has_backs && surface < kMostDeepSurfaces; surface++) add(surface, true);
  if (source[RawPlane::behind].size() > kMostBehindPlanes)
    fail(ErrorKind::input, "{}: with --behind these are {} planes of depth, and a frame takes {}: leave some out",
         file.path(), source[RawPlane::behind].size(), kMostBehindPlanes);
}

DeepRules deep_rules(const FrameSource& source, const ExrFile& file, const std::vector<int>& parts,
                     const InputSettings& settings) {
  const View view = view_of(source.camera, source.data, source.display);
  const double pixel = std::abs(double(view.tangent_per_pixel.x));
  const double precision = is_half(file, parts) ? kHalfPrecision : kLeastPrecision;
  DeepRules rules{.opacity = settings.deep_opacity, .separation = {0, kPrecisions * precision, 0}};
  rules.separation[view.orthographic ? 0 : 1] += view.orthographic ? pixel / source.depth_scale : pixel;
  return rules;
}

void take_deep(FrameSource& source, const InputSettings& settings) {
  if (!source.deep) return;
  ExrFile& file = source.files[*source.deep];
  file.take_deep(source.deep_parts, deep_rules(source, file, source.deep_parts, settings));
}

bool is_deep_plane(const FrameSource& source, std::size_t plane) {
  const ChannelRef& ref = source[RawPlane::behind][plane];
  return source.part_of(ref).deep.has_value();
}

void read_deep_like_meaning(FrameSource& source) {
  if (!source.deep) return;
  for (std::size_t plane = 0; plane < source.behind.size(); plane++)
    if (is_deep_plane(source, plane)) {
      source.behind[plane].depth_kind = source.deep_kind;
      source.behind[plane].scale = source.deep_scale;
      source.behind[plane].is_whole = source.deep_is_whole;
    }
}

void settle_deep(FrameSource& source, std::span<const float> depth) {
  if (!source.deep) return;
  source.deep_is_whole =
      !source.behind.empty() && goes_on_behind(source.files[*source.deep], source.deep_parts.front(), source.file_data);
  read_deep_like_meaning(source);
  const ChannelRef& own = source[RawPlane::depth][0];
  if (own.file == *source.deep && source.part_of(own).deep) return;
  std::vector<DeepReading> readings;
  for (const double scale : {source.depth_scale, 1.0})
    for (const DepthKind kind : {DepthKind::planar, DepthKind::ray}) readings.push_back({kind, scale});
  ExrFile& file = source.files[*source.deep];
  const View view = view_of(source.camera, source.data, source.display);
  const DepthMap map = depth_map_of(source);
  const double tolerance = 2 * std::abs(double(view.tangent_per_pixel.x)) + 2 * kHalfPrecision;
  const auto width = std::size_t(source.data.width);
  std::vector<float> first(std::size_t(source.file_data.width));
  const ExrRead read{source.deep_parts.front(), deep_channel(0, false), first.data()};
  std::size_t compared = 0, found = 0;
  const int step = std::max(1, source.data.height / kEvidenceRows);
  for (int y = step / 2; y < source.data.height; y += step) {
    file.read(std::span(&read, 1), source.data.y + y - source.file_data.y, 1);
    for (std::size_t x = 0; x < width; x++) {
      const double ty = (y + 0.5 - view.center.y) * view.tangent_per_pixel.y;
      const double tx = (double(x) + 0.5 - view.center.x) * view.tangent_per_pixel.x;
      const double ray = view.orthographic ? 1 : std::sqrt(1 + tx * tx + ty * ty);
      std::array<double, 3> values{};
      for (std::size_t axis = 0; axis < source[RawPlane::depth].size(); axis++)
        values[axis] = depth[axis * source.data.pixels() + std::size_t(y) * width + x];
      const double z = planar_depth(map, values, ray);
      const double raw = first[x + std::size_t(source.data.x - source.file_data.x)];
      found += raw < double(kNoDeepSurface);
      if (!std::isfinite(z) || raw >= double(kNoDeepSurface)) continue;
      compared++;
      for (auto& reading : readings) {
        const double planar = raw * reading.scale / (reading.kind == DepthKind::ray ? ray : 1);
        reading.same += std::abs(planar / z - 1) <= tolerance;
      }
    }
  }
  if (found == 0)
    source.notes.push_back(
        {NoteCode::empty_layer, fmt::format("{}: no deep sample is a surface by --deep-opacity", file.path())});
  if (compared < kLeastPixels) return;
  const auto best = std::ranges::max_element(readings, {}, &DeepReading::same);
  if (double(best->same) < kLeastSame * double(compared))
    fail(
        ErrorKind::input,
        "{}: the first surfaces of its deep samples are the depth of {} on {:.2g} % of the pixels only, be they planar "
        "or along the ray: give --deep the samples of the same frame and camera, and other elements, flat, to "
        "--behind; --depth-kind and --depth-scale say how the depth is read",
        file.path(), source.depth_path(), 100.0 * double(best->same) / double(compared));
  const bool is_own = best->kind == source.depth_kind && best->scale == source.depth_scale;
  source.deep_kind = is_own ? DepthKind::automatic : best->kind;
  source.deep_scale = is_own ? 1 : best->scale;
  read_deep_like_meaning(source);
}

Notes deep_notes(const FrameSource& source) {
  if (!source.deep) return {};
  const ExrFile& file = source.files[*source.deep];
  const DeepCounts counts = file.deep_counts();
  if (counts.repaired == 0) return {};
  return {{NoteCode::repaired_samples,
           fmt::format("{}: {:.2g} % of the deep samples have an opacity that is no number from 0 to 1, or no depth: "
                       "they count as the nearest that is one, and as clear where there is none",
                       file.path(), 100.0 * double(counts.repaired) / double(counts.samples))}};
}

}  // namespace alcove
