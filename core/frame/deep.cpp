// Finding deep parts, and telling the kind of their depth by the flat one.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/deep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/base/windows.h"
#include "core/frame/input_files.h"
#include "core/frame/views.h"

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

/// Takes a file's samples for the frame, and those of all other files of --deep.
void choose(FrameSource& source, ChannelSearch& search, std::size_t file, const InputSettings& settings) {
  source.deep = file;
  source.deep_parts = deep_parts_of(source.files[file], settings.layer, source.view);
  source.deep_elements.clear();
  for (const auto& path : settings.deep) {
    if (path.empty() || path == source.files[file].path()) continue;
    const std::size_t other = search.open(path, "--deep");
    source.deep_elements.emplace_back(other, deep_parts_of(source.files[other], settings.layer, source.view));
  }
}

const std::string& first_of(const FileList& files) {
  return *std::ranges::find_if(files, [](const std::string& file) { return !file.empty(); });
}

/// Fails where a file has no samples of the view.
void require_samples(const FrameSource& source, std::size_t file, const std::vector<int>& parts) {
  if (parts.empty())
    fail(ErrorKind::input, "{}: it holds no deep data{}; --behind takes flat depth (--deep)", source.files[file].path(),
         source.view.empty() ? "" : fmt::format(" of the view {}", source.view));
}

/// Calls a function for all files of samples and their parts, the first one first.
template <class Visit>
void for_each_deep(const FrameSource& source, const Visit& visit) {
  visit(*source.deep, source.deep_parts);
  for (const auto& [file, parts] : source.deep_elements) visit(file, parts);
}

/// The pixels that some of the samples' parts have. A renderer may have cut each element to its own.
Window window_of_samples(const FrameSource& source) {
  std::uint64_t pixels = 0;
  std::int64_t left = std::numeric_limits<std::int64_t>::max(), top = left, right = -left, bottom = -left;
  for_each_deep(source, [&](std::size_t file, const std::vector<int>& parts) {
    for (const int part : parts) {
      const Window& data = source.files[file].parts()[std::size_t(part)].data;
      pixels += data.pixels();
      left = std::min<std::int64_t>(left, data.x);
      top = std::min<std::int64_t>(top, data.y);
      right = std::max(right, std::int64_t(data.x) + data.width);
      bottom = std::max(bottom, std::int64_t(data.y) + data.height);
    }
  });
  // Files that hold little must not make a picture that no memory holds.
  constexpr std::int64_t kMost = std::numeric_limits<int>::max();
  constexpr std::uint64_t kMostTimes = 4;
  const bool fits = right - left <= kMost && bottom - top <= kMost;
  const std::uint64_t most =
      std::max<std::uint64_t>(source.files[*source.deep].display().pixels(), kMostTimes * pixels);
  if (!fits || std::uint64_t(right - left) * std::uint64_t(bottom - top) > most)
    fail(ErrorKind::input, "{}: its deep parts and those beside them are too far apart for one picture (--deep)",
         source.files[*source.deep].path());
  return {int(left), int(top), int(right - left), int(bottom - top)};
}

bool any_deep(const FrameSource& source, bool (*holds)(const ExrFile&, const std::vector<int>&)) {
  bool any = false;
  for_each_deep(source, [&](std::size_t file, const auto& parts) { any = any || holds(source.files[file], parts); });
  return any;
}

bool has_backs(const ExrFile& file, const std::vector<int>& parts) {
  return std::ranges::any_of(parts, [&](int part) { return has_channel(file.parts()[std::size_t(part)], "ZBack"); });
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

std::vector<int> deep_parts_of(const ExrFile& file, const std::string& layer, const std::string& view) {
  const std::string in_file = view_in(file, view);
  std::vector<int> of_view, of_layer;
  for (std::size_t i = 0; i < file.parts().size(); i++) {
    const ExrPart& part = file.parts()[i];
    if (!part.deep || (!part.view.empty() && !same_name(part.view, in_file))) continue;
    of_view.push_back(int(i));
    if (!layer.empty() && (same_name(part.name, layer) || same_name(layer_of(part), layer))) of_layer.push_back(int(i));
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
    choose(source, search, depth_file, settings);
  } else {
    if (!has_deep(settings) || !settings.depth.empty() || !search.find(depth_file, kDepthNames, "", false).empty() ||
        search.find_by_rules(depth_file, kDepthNames, "", source.rules->depth).candidate)
      return {};
    choose(source, search, search.open(first_of(settings.deep), "--deep"), settings);
  }
  if (source.deep_parts.empty()) {
    source.deep.reset();
    return {};
  }
  source.deep_data = window_of_samples(source);
  source.deep_depth_is_half = any_deep(source, is_half);
  return {{*source.deep, source.deep_parts.front(), deep_channel(0, false)}};
}

void find_deep(FrameSource& source, ChannelSearch& search, const InputSettings& settings) {
  const bool is_depth = source.deep.has_value();
  if (!is_depth && !has_deep(settings)) return;
  if (!is_depth) choose(source, search, search.open(first_of(settings.deep), "--deep"), settings);
  if (!is_depth) source.deep_data = source.file_data;
  for_each_deep(source, [&](std::size_t place, const std::vector<int>& parts) {
    require_samples(source, place, parts);
    const ExrFile& file = source.files[place];
    if (file.display() != source.display)
      fail(ErrorKind::input,
           "{}: its deep samples are of a picture of {}, and the depth of {} is of {}: both must cover the same pixels "
           "(--deep)",
           file.path(), to_string(file.display()), source.depth_path(), to_string(source.display));
  });
  if (common_part(window_of_samples(source), source.file_data).pixels() == 0)
    fail(ErrorKind::input, "{}: its deep samples are {}, and the depth of {} is {}: they share no pixel (--deep)",
         source.files[*source.deep].path(), to_string(window_of_samples(source)), source.depth_path(),
         to_string(source.file_data));
  const ExrFile& file = source.files[*source.deep];
  const int first = source.deep_parts.front();
  const bool half = any_deep(source, is_half), backs = any_deep(source, has_backs);
  const auto add = [&](std::size_t surface, bool back) {
    source[RawPlane::behind].push_back({*source.deep, first, deep_channel(surface, back)});
    source.behind.push_back(
        {.kind = back ? BehindKind::backs : BehindKind::surfaces, .is_half = half, .is_whole = false});
  };
  for (std::size_t surface = is_depth ? 1 : 0; surface < kMostDeepSurfaces; surface++) add(surface, false);
  for (std::size_t surface = 0; backs && surface < kMostDeepSurfaces; surface++) add(surface, true);
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
  std::vector<DeepElement> others;
  for (const auto& [other, parts] : source.deep_elements) others.push_back({&source.files[other], parts});
  DeepRules rules = deep_rules(source, file, source.deep_parts, settings);
  for (const auto& other : others) {
    const DeepRules theirs = deep_rules(source, *other.file, other.parts, settings);
    rules.separation[1] = std::max(rules.separation[1], theirs.separation[1]);
  }
  file.take_deep(source.deep_parts, rules, source.deep_data, others);
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
        {NoteCode::empty_layer, fmt::format("{}: no deep sample is a surface by --set deep-opacity", file.path())});
  if (compared < kLeastPixels) return;
  const auto best = std::ranges::max_element(readings, {}, &DeepReading::same);
  if (double(best->same) < kLeastSame * double(compared))
    fail(
        ErrorKind::input,
        "{}: the first surfaces of its deep samples are the depth of {} on {:.2g} % of the pixels only, be they planar "
        "or along the ray: give --deep the samples of the same frame and camera, of all its elements, and flat depth "
        "of others to --behind; --depth-kind and --depth-scale say how the depth is read",
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
