// Finding planes behind the first surface and deep samples, and what their pixels say for and against them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/behind.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/base/option_words.h"
#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/frame/camera/camera.h"
#include "core/frame/find/channels.h"
#include "core/frame/raw_plane.h"
#include "core/frame/samples.h"

namespace alcove {

// Planes of --behind.

namespace {

const AovNames& behind_names() {
  static const AovNames names = [] {
    AovNames depth = kDepthNames;
    depth.channel_option = "--set behind-channel";
    return depth;
  }();
  return names;
}

/// Gives a setting of a file, which is said once for all files or for each of them.
template <class T>
T said_of(const std::vector<T>& all, std::size_t file, T otherwise) {
  if (all.empty()) return otherwise;
  return all.size() == 1 ? all.front() : all[file];
}

/// The pixels of a plane are those of the depth.
void require_same_pixels(const FrameSource& source, const ChannelRef& ref) {
  const ChannelRef& depth = source.channels[RawPlane::depth][0];
  const ExrFile &file = source.file_of(ref), &own = source.file_of(depth);
  if (file.display() != source.reading.display)
    fail(ErrorKind::input,
         "{}: its display window is {}, and that of the depth in {} is {}: both must show the same pixels (--behind)",
         file.path(), to_string(file.display()), own.path(), to_string(source.reading.display));
  require_same_picture(source, {ref}, "depth", "--behind");
  const std::string theirs = view_in(file, source.channels.view), ours = view_in(own, source.channels.view);
  if (!theirs.empty() && !ours.empty() && !same_name(theirs, ours))
    fail(ErrorKind::input,
         "{}: its view is {}, and that of the depth in {} is {}: give the same of both (--behind, "
         "--view)",
         file.path(), theirs, own.path(), ours);
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
    const ExrFile& file = source.file_of(channel);
    return header_camera(file.attribute_texts(channel.part), source.reading.display, source.reading.data,
                         source.reading.pixel_aspect, source.layer_of(channel));
  };
  const auto theirs = camera_of(ref), ours = camera_of(source.channels[RawPlane::depth][0]);
  if (theirs && ours && !is_same_camera(theirs->camera, ours->camera))
    source.notes.push_back({NoteCode::said_otherwise,
                            fmt::format("the camera in the header of {} is another than that in the header of {}: are "
                                        "they of the same frame (--behind)?",
                                        source.file_of(ref).path(), source.depth_path())});
}

/// The one channel of a file.
ChannelRef find_channel(FrameSource& source, ChannelSearch& search, std::size_t file, const std::string& chosen) {
  const ChannelRef& depth = source.channels[RawPlane::depth][0];
  const bool is_alone = file != depth.file;
  auto found = search.find_by_rules(file, behind_names(), chosen, source.program.rules->depth).channels;
  if (found.empty()) found = search.require(file, behind_names(), chosen, is_alone, "Z");
  if (found[0] == depth)
    fail(ErrorKind::input,
         "{}: {} is the depth of the frame itself: name the channel of the surfaces behind it with --set "
         "behind-channel, or give another file with --behind",
         source.files[file].path(), found[0].channel);
  return found[0];
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
    if (ref.file != source.channels[RawPlane::depth][0].file) note_other_camera(source, ref);
    const BehindKind kind = said_of(settings.behind_kinds, number, BehindKind::surfaces);
    source.channels[RawPlane::behind].push_back(ref);
    source.reading.behind.push_back({.kind = kind, .is_half = source.is_half(ref)});
    if (source.reading.behind.back().is_half && !source.reading.depth_is_half)
      source.suspicious.push_back(
          {NoteCode::half_depth, fmt::format("{} of {} is stored as half float, unlike the depth: hidden surfaces are "
                                             "off by up to a 2048th of their depth; write it as float",
                                             ref.channel, path)});
    number++;
  }
}

std::string hidden_sources_text(const FrameSource& source) {
  std::vector<std::string> sources;
  for (std::size_t i = 0; i < source.channels[RawPlane::behind].size(); i++) {
    const ChannelRef& ref = source.channels[RawPlane::behind][i];
    sources.push_back(fmt::format("{} {} {}", std::filesystem::path(source.file_of(ref).path()).filename().string(),
                                  ref.channel, word_of(source.reading.behind[i].kind)));
  }
  std::ranges::sort(sources);
  return fmt::format("{}", fmt::join(sources, "; "));
}

// Their pixels.

namespace {

constexpr std::size_t kSampled = 1 << 18;      // pixels of a frame: enough to find a thing of a few pixels
constexpr std::size_t kLeastSurfaces = 64;     // fewer tell too little
constexpr double kSameSurface = 4;             // precisions, beside a pixel's slope, within which two depths are one
constexpr double kRefused = 0.5;               // share of the surfaces before the first one
constexpr double kNoted = 0.05;                // the same; edges of antialiased elements give some
constexpr double kAsDeep = 0.9;                // share of the surfaces whose thickness is no less than their depth
constexpr double kOblique = 1.002;             // length of a ray, of unit depth
constexpr double kEqual = 5e-4;                // of the depth: much less than the length of oblique rays makes
constexpr double kLeastOtherwise = 0.05;       // share of the oblique surfaces
constexpr std::size_t kFarMoreOtherwise = 10;  // times as many as read as it is

std::string name_of(const FrameSource& source, std::size_t plane) {
  const ChannelRef& ref = source.channels[RawPlane::behind][plane];
  return fmt::format("{}: {}", source.file_of(ref).path(), ref.channel);
}

/// Whether a plane of RawPlane::behind comes from samples.
bool is_deep_plane(const FrameSource& source, std::size_t plane) {
  const ChannelRef& ref = source.channels[RawPlane::behind][plane];
  return source.part_of(ref).deep.has_value();
}

/// The file of samples whose channels are read.
ExrFile& deep_file(FrameSource& source) { return source.files[source.channels.deep->elements[0].file]; }
const ExrFile& deep_file(const FrameSource& source) { return source.files[source.channels.deep->elements[0].file]; }
/// The part of that file which stands for all.
int deep_part(const FrameSource& source) { return source.channels.deep->elements[0].parts.front(); }

double percent(std::size_t part, std::size_t whole) { return 100.0 * double(part) / double(whole); }

/// The first surface at a pixel.
struct FirstSurface {
  double z, ray;
  double separation;  // of surfaces that are two

  bool is_one(double a, double b) const { return std::abs(a - b) <= separation; }
};

/// Counts a surface of a plane.
void add_surface(BehindCounts& plane, double z, bool along_ray, const FirstSurface& first) {
  plane.before += z < first.z - first.separation;
  plane.same += first.is_one(z, first.z);
  plane.parts.push_back(float(z / first.z));
  if (first.ray < kOblique) return;
  const double other = along_ray ? z * first.ray : z / first.ray;
  plane.oblique++;
  plane.as_read += std::abs(z - first.z) < kEqual * first.z;
  plane.otherwise += std::abs(other - first.z) < kEqual * first.z;
}

/// Counts the planes' depths at a pixel.
void count(std::vector<BehindCounts>& planes, const Reading& reading, std::span<const double> depths,
           std::span<const DepthMap> maps, const FirstSurface& first) {
  for (std::size_t p = 0; p < depths.size(); p++) {
    const BehindKind kind = reading.behind[p].kind;
    if (!std::isfinite(depths[p])) continue;
    planes[p].surfaces++;
    if (kind == BehindKind::thickness) {
      planes[p].as_deep += depths[p] >= first.z - first.separation;
      continue;
    }
    bool is_known = first.is_one(depths[p], first.z);
    for (std::size_t q = 0; q < p; q++)
      is_known = is_known || (reading.behind[q].kind == kind && first.is_one(depths[p], depths[q]));
    planes[p].known += is_known;
    add_surface(planes[p], depths[p], maps[p].along_ray, first);
  }
}

}  // namespace

void BehindSample::add(const Reading& reading, std::span<const float> depth, std::span<const float> behind,
                       const Window& window, const Window& whole) {
  planes_.resize(reading.behind.size());
  if (planes_.empty()) return;
  taken_.resize(whole.pixels() / sampling_step(whole, kSampled) + 1);
  const View view = view_of(reading.camera, window, reading.display);
  const DepthMap own = depth_map_of(reading);
  const DepthPrecision precision = hidden_precision_of(reading);
  std::vector<DepthMap> maps;
  for (const auto& plane : reading.behind) maps.push_back(behind_map_of(reading, plane));
  for_each_sampled(view, depth, window, whole, kSampled, [&](const SampledPixel& pixel) {
    if (taken_[pixel.number]) return;
    taken_[pixel.number] = true;
    const double z = planar_depth(own, pixel.values, pixel.ray);
    const double width = std::abs(view.tangent_per_pixel.x) * (view.orthographic ? 1 : z);
    const FirstSurface first{z, pixel.ray, kSameSurface * precision.at_depth(z) + width};
    std::vector<double> depths;
    for (std::size_t p = 0; p < maps.size(); p++) {
      const double raw = behind[pixel.at + p * window.pixels()];
      planes_[p].negative += raw < 0;
      depths.push_back(planar_depth(maps[p], {raw, 0, 0}, pixel.ray));
    }
    if (std::isfinite(z)) count(planes_, reading, depths, maps, first);
  });
}

Notes BehindSample::notes(const FrameSource& source) const {
  Notes notes;
  std::size_t new_surfaces = 0;  // of deep samples
  for (std::size_t plane = 0; plane < planes_.size(); plane++)
    if (is_deep_plane(source, plane))
      new_surfaces += planes_[plane].surfaces - planes_[plane].before - planes_[plane].same;
    else
      add_new(notes, notes_of(source, plane));
  if (source.channels.deep && !planes_.empty() && new_surfaces == 0)
    notes.push_back({NoteCode::nothing_hidden,
                     fmt::format("{} holds no surface behind the first one: its elements were rendered in one go; "
                                 "render them apart and give them all to --deep, or give peels to --behind",
                                 deep_file(source).path())});
  return notes;
}

// What the numbers of a plane say.

namespace {

void refuse_negative(const BehindCounts& plane, const std::string& name, std::size_t pixels) {
  if (plane.negative == 0) return;
  fail(ErrorKind::input,
       "{} is below 0 on {:.2g} % of the pixels, and a thickness is the extent of a solid behind its front: name "
       "another channel with --set behind-channel, or give the right --behind-kind",
       name, percent(plane.negative, pixels));
}

Notes thickness_notes(const BehindCounts& plane, const std::string& name) {
  if (double(plane.as_deep) < kAsDeep * double(plane.surfaces)) return {};
  return {{NoteCode::said_otherwise,
           fmt::format("{} is as large as the depth, or larger, on {:.0f} % of the surfaces, too much for a thickness: "
                       "if it is the depth of back faces, give --behind-kind backs",
                       name, percent(plane.as_deep, plane.surfaces))}};
}

/// Fails where a plane is not the depth of the same frame and camera, or is read as the other kind.
void refuse_other_depth(const BehindCounts& plane, const std::string& name, bool along_ray, const std::string& depth) {
  if (double(plane.otherwise) > kLeastOtherwise * double(plane.oblique) &&
      plane.otherwise > kFarMoreOtherwise * plane.as_read)
    fail(ErrorKind::input,
         "{} equals the frame's own depth on {:.0f} % of the pixels if read as {}, but is read as {}, as the depth of "
         "{} is: write both alike, or name another channel with --set behind-channel; --depth-kind says how both are "
         "read",
         name, percent(plane.otherwise, plane.oblique), along_ray ? "planar" : "along the ray",
         along_ray ? "along the ray" : "planar", depth);
  if (double(plane.before) < kRefused * double(plane.surfaces)) return;
  fail(ErrorKind::input,
       "{} lies before the first surface on {:.0f} % of the pixels, at {:.3g} times its depth: it is of another frame "
       "or camera than the depth of {}, or has another scale or kind; give another file with --behind, name another "
       "channel with --set behind-channel, or say with --depth-kind and --depth-scale how both are read",
       name, percent(plane.before, plane.surfaces), median_of(plane.parts), depth);
}

Notes surface_notes(const BehindCounts& plane, const std::string& name) {
  Notes notes;
  if (double(plane.before) > kNoted * double(plane.surfaces))
    notes.push_back(
        {NoteCode::before_first, fmt::format("{} lies before the first surface on {:.0f} % of the pixels, and is left "
                                             "out there: check that it is of the same frame and camera (--behind)",
                                             name, percent(plane.before, plane.surfaces))});
  if (plane.same == plane.surfaces)
    notes.push_back({NoteCode::nothing_hidden,
                     fmt::format("{} shows nothing but the first surface: name the channel of the surfaces behind it "
                                 "with --set behind-channel, or give another file with --behind",
                                 name)});
  else if (plane.known == plane.surfaces)
    notes.push_back({NoteCode::nothing_hidden,
                     fmt::format("{} shows nothing new: earlier planes have all its surfaces; name another channel "
                                 "with --set behind-channel, give another file, or leave it out (--behind)",
                                 name)});
  return notes;
}

}  // namespace

Notes BehindSample::notes_of(const FrameSource& source, std::size_t number) const {
  const BehindCounts& plane = planes_[number];
  const BehindPlane& said = source.reading.behind[number];
  const std::string name = name_of(source, number);
  const bool is_thickness = said.kind == BehindKind::thickness;
  if (is_thickness) refuse_negative(plane, name, std::size_t(std::ranges::count(taken_, true)));
  if (plane.surfaces == 0)
    return {{NoteCode::empty_layer, fmt::format("{} shows no surface where the depth has one (--behind)", name)}};
  if (plane.surfaces < kLeastSurfaces) return {};
  if (is_thickness) return thickness_notes(plane, name);
  refuse_other_depth(plane, name, behind_map_of(source.reading, said).along_ray, source.depth_path());
  return surface_notes(plane, name);
}

// Deep samples.

namespace {

constexpr double kPrecisions = 4;            // surfaces are one within so many times what a depth may be off
constexpr double kLeastPrecision = 0x1p-16;  // of the depth, see depth_precision()
constexpr int kEvidenceRows = 64;            // of the frame, by which the kind of samples is settled
constexpr double kWhole = 0.5;               // share of the surfaces with another one behind
constexpr std::size_t kLeastPixels = 64;     // fewer tell too little
constexpr double kLeastSame = 0.1;           // share of the pixels whose first surface must be the depth's

template <class Is>
bool any_channel(const ExrFile& file, const std::vector<int>& parts, const Is& is) {
  return std::ranges::any_of(
      parts, [&](int part) { return std::ranges::any_of(file.parts()[std::size_t(part)].channels, is); });
}

bool is_half(const ExrFile& file, const std::vector<int>& parts) {
  return any_channel(file, parts,
                     [](const ExrChannel& c) { return c.name == "Z" && c.type == SampleType::half_float; });
}

bool has_backs(const ExrFile& file, const std::vector<int>& parts) {
  return any_channel(file, parts, [](const ExrChannel& c) { return c.name == "ZBack"; });
}

/// Takes a file's samples for the frame, and those of all other files of --deep.
void choose(FrameSource& source, ChannelSearch& search, std::size_t file, const InputSettings& settings) {
  auto& elements = source.channels.deep.emplace().elements;
  const auto add = [&](std::size_t place) {
    elements.push_back({place, deep_parts_of(source.files[place], settings.layer, source.channels.view)});
  };
  add(file);
  for (const auto& path : settings.deep)
    if (!path.empty() && path != source.files[file].path()) add(search.open(path, "--deep"));
}

const std::string& first_of(const FileList& files) {
  return *std::ranges::find_if(files, [](const std::string& file) { return !file.empty(); });
}

/// Fails where a file has no samples of the view.
void require_samples(const FrameSource& source, const DeepFiles::Element& element) {
  if (element.parts.empty())
    fail(ErrorKind::input, "{}: it holds no deep data{}; --behind takes flat depth (--deep)",
         source.files[element.file].path(),
         source.channels.view.empty() ? "" : fmt::format(" of the view {}", source.channels.view));
}

/// The pixels that some of the samples' parts have. A renderer may have cut each element to its own.
Window window_of_samples(const FrameSource& source) {
  std::uint64_t pixels = 0;
  std::int64_t left = std::numeric_limits<std::int64_t>::max(), top = left, right = -left, bottom = -left;
  for (const auto& [file, parts] : source.channels.deep->elements)
    for (const int part : parts) {
      const Window& data = source.files[file].parts()[std::size_t(part)].data;
      pixels += data.pixels();
      left = std::min<std::int64_t>(left, data.x);
      top = std::min<std::int64_t>(top, data.y);
      right = std::max(right, std::int64_t(data.x) + data.width);
      bottom = std::max(bottom, std::int64_t(data.y) + data.height);
    }
  // Files that hold little must not make a picture that no memory holds.
  constexpr std::int64_t kMost = std::numeric_limits<int>::max();
  constexpr std::uint64_t kMostTimes = 4;
  const bool fits = right - left <= kMost && bottom - top <= kMost;
  const std::uint64_t most = std::max<std::uint64_t>(deep_file(source).display().pixels(), kMostTimes * pixels);
  if (!fits || std::uint64_t(right - left) * std::uint64_t(bottom - top) > most)
    fail(ErrorKind::input, "{}: its parts are too far apart for one picture (--deep)", deep_file(source).path());
  return {int(left), int(top), int(right - left), int(bottom - top)};
}

bool any_deep(const FrameSource& source, bool (*holds)(const ExrFile&, const std::vector<int>&)) {
  return std::ranges::any_of(source.channels.deep->elements, [&](const DeepFiles::Element& element) {
    return holds(source.files[element.file], element.parts);
  });
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

/// A way to read the depth of samples.
struct DeepReading {
  DepthKind kind;
  double scale;
  std::size_t same = 0;  // pixels whose first surface is the depth's
};

/// The first surfaces of samples against those of the depth, at some rows.
struct FirstSurfaces {
  std::size_t found = 0, compared = 0;  // pixels with a sample that is a surface, and where the depth has one, too
  std::vector<DeepReading> readings;
};

FirstSurfaces compare_first(FrameSource& source, const RawPart& raw) {
  FirstSurfaces first;
  for (const double scale : {source.reading.depth_scale, 1.0})
    for (const DepthKind kind : {DepthKind::planar, DepthKind::ray}) first.readings.push_back({kind, scale});
  const Window& whole = source.reading.data;
  const View view = view_of(source.reading, raw.window);
  const DepthMap map = depth_map_of(source.reading);
  const double tolerance = 2 * std::abs(double(view.tangent_per_pixel.x)) + 2 * kHalfPrecision;
  const auto width = std::size_t(raw.window.width);
  std::vector<float> row(std::size_t(whole.width));
  const ExrRead read{deep_part(source), deep_channel(0, false), row.data()};
  const int step = std::max(1, raw.window.height / kEvidenceRows);
  for (int y = step / 2; y < raw.window.height; y += step) {
    deep_file(source).read(std::span(&read, 1), raw.window.y + y - whole.y, 1);
    for (std::size_t x = 0; x < width; x++) {
      const double ray = ray_length(view, int(x), y);
      const double z = planar_depth(map, value_at(raw.depth, raw.window.pixels(), std::size_t(y) * width + x), ray);
      const double sample = row[x + std::size_t(raw.window.x - whole.x)];
      first.found += sample < double(kNoDeepSurface);
      if (!std::isfinite(z) || sample >= double(kNoDeepSurface)) continue;
      first.compared++;
      for (auto& reading : first.readings) {
        const double planar = sample * reading.scale / (reading.kind == DepthKind::ray ? ray : 1);
        reading.same += std::abs(planar / z - 1) <= tolerance;
      }
    }
  }
  return first;
}

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

std::vector<ChannelRef> find_deep_depth(FrameSource& source, ChannelSearch& search, std::size_t depth_file,
                                        const InputSettings& settings) {
  if (!settings.depth_channel.empty()) return {};
  const auto& parts = source.files[depth_file].parts();
  if (std::ranges::all_of(parts, [](const ExrPart& part) { return part.deep.has_value(); })) {
    choose(source, search, depth_file, settings);
  } else {
    if (!has_deep(settings) || !settings.depth.empty() || !search.find(depth_file, kDepthNames, "", false).empty() ||
        search.find_by_rules(depth_file, kDepthNames, "", source.program.rules->depth).candidate)
      return {};
    choose(source, search, search.open(first_of(settings.deep), "--deep"), settings);
  }
  if (source.channels.deep->elements[0].parts.empty()) {
    source.channels.deep.reset();
    return {};
  }
  source.channels.deep->data = window_of_samples(source);
  source.channels.deep->depth_is_half = any_deep(source, is_half);
  return {{source.channels.deep->elements[0].file, deep_part(source), deep_channel(0, false)}};
}

void find_deep(FrameSource& source, ChannelSearch& search, const InputSettings& settings) {
  const bool is_depth = source.channels.deep.has_value();
  if (!is_depth && !has_deep(settings)) return;
  if (!is_depth) choose(source, search, search.open(first_of(settings.deep), "--deep"), settings);
  if (!is_depth) source.channels.deep->data = source.reading.data;
  for (const auto& element : source.channels.deep->elements) {
    require_samples(source, element);
    const ExrFile& file = source.files[element.file];
    if (file.display() != source.reading.display)
      fail(ErrorKind::input,
           "{}: its deep samples are of a picture of {}, and the depth of {} is of {}: both must cover the same pixels "
           "(--deep)",
           file.path(), to_string(file.display()), source.depth_path(), to_string(source.reading.display));
  }
  if (common_part(window_of_samples(source), source.reading.data).pixels() == 0)
    fail(ErrorKind::input, "{}: its deep samples are {}, and the depth of {} is {}: they share no pixel (--deep)",
         deep_file(source).path(), to_string(window_of_samples(source)), source.depth_path(),
         to_string(source.reading.data));
  const ExrFile& file = deep_file(source);
  const int first = deep_part(source);
  const bool half = any_deep(source, is_half), backs = any_deep(source, has_backs);
  const auto add = [&](std::size_t surface, bool back) {
    source.channels[RawPlane::behind].push_back(
        {source.channels.deep->elements[0].file, first, deep_channel(surface, back)});
    source.reading.behind.push_back(
        {.kind = back ? BehindKind::backs : BehindKind::surfaces, .is_half = half, .is_whole = false});
  };
  for (std::size_t surface = is_depth ? 1 : 0; surface < kMostDeepSurfaces; surface++) add(surface, false);
  for (std::size_t surface = 0; backs && surface < kMostDeepSurfaces; surface++) add(surface, true);
  if (source.channels[RawPlane::behind].size() > kMostBehindPlanes)
    fail(ErrorKind::input, "{}: with --behind these are {} planes of depth, and a frame takes {}: leave some out",
         file.path(), source.channels[RawPlane::behind].size(), kMostBehindPlanes);
}

DeepRules deep_rules(const FrameSource& source, const ExrFile& file, const std::vector<int>& parts,
                     const InputSettings& settings) {
  const View view = view_of(source.reading, source.reading.data);
  const double pixel = std::abs(double(view.tangent_per_pixel.x));
  const double precision = is_half(file, parts) ? kHalfPrecision : kLeastPrecision;
  DeepRules rules{.opacity = settings.deep_opacity, .separation = {0, kPrecisions * precision, 0}};
  rules.separation[view.orthographic ? 0 : 1] += view.orthographic ? pixel / source.reading.depth_scale : pixel;
  return rules;
}

void take_deep(FrameSource& source, const InputSettings& settings) {
  if (!source.channels.deep) return;
  const DeepFiles& deep = *source.channels.deep;
  DeepRules rules = deep_rules(source, deep_file(source), deep.elements[0].parts, settings);
  std::vector<DeepElement> others;
  for (std::size_t i = 1; i < deep.elements.size(); i++) {
    ExrFile& file = source.files[deep.elements[i].file];
    const DeepRules theirs = deep_rules(source, file, deep.elements[i].parts, settings);
    rules.separation[1] = std::max(rules.separation[1], theirs.separation[1]);
    others.push_back({&file, deep.elements[i].parts});
  }
  deep_file(source).take_deep(deep.elements[0].parts, rules, deep.data, others);
}

void read_deep_like_meaning(FrameSource& source) {
  if (!source.channels.deep) return;
  for (std::size_t plane = 0; plane < source.reading.behind.size(); plane++)
    if (is_deep_plane(source, plane)) {
      source.reading.behind[plane].depth_kind = source.reading.deep_kind;
      source.reading.behind[plane].scale = source.reading.deep_scale;
      source.reading.behind[plane].is_whole = source.reading.deep_is_whole;
    }
}

void settle_deep(FrameSource& source, const RawPart& raw) {
  if (!source.channels.deep) return;
  source.reading.deep_is_whole =
      !source.reading.behind.empty() && goes_on_behind(deep_file(source), deep_part(source), source.reading.data);
  read_deep_like_meaning(source);
  const ChannelRef& own = source.channels[RawPlane::depth][0];
  if (own.file == source.channels.deep->elements[0].file && source.part_of(own).deep) return;
  const FirstSurfaces first = compare_first(source, raw);
  const std::string& path = deep_file(source).path();
  if (first.found == 0)
    source.notes.push_back(
        {NoteCode::empty_layer, fmt::format("{}: no deep sample is a surface by --set deep-opacity", path)});
  if (first.compared < kLeastPixels) return;
  const auto best = std::ranges::max_element(first.readings, {}, &DeepReading::same);
  if (double(best->same) < kLeastSame * double(first.compared))
    fail(ErrorKind::input,
         "{}: the first surfaces of its deep samples are the depth of {} on {:.2g} % of the pixels only, both as "
         "planar depth and along the ray: give --deep all elements of the same frame and camera, and give flat depth "
         "to --behind; --depth-kind and --depth-scale say how the depth is read",
         path, source.depth_path(), percent(best->same, first.compared));
  const bool is_own = best->kind == source.reading.depth_kind && best->scale == source.reading.depth_scale;
  source.reading.deep_kind = is_own ? DepthKind::automatic : best->kind;
  source.reading.deep_scale = is_own ? 1 : best->scale;
  read_deep_like_meaning(source);
}

Notes deep_notes(const FrameSource& source) {
  if (!source.channels.deep) return {};
  const ExrFile& file = deep_file(source);
  const DeepCounts counts = file.deep_counts();
  if (counts.repaired == 0) return {};
  return {{NoteCode::repaired_samples,
           fmt::format("{}: {:.2g} % of the deep samples have an opacity outside 0 to 1, or no depth: their opacity "
                       "becomes the nearest valid one, and without one they count as clear",
                       file.path(), 100.0 * double(counts.repaired) / double(counts.samples))}};
}

}  // namespace alcove
