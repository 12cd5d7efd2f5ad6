// What the pixels of planes behind the first surface say for and against them.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/base/ranks.h"
#include "core/frame/behind.h"
#include "core/frame/deep.h"
#include "core/frame/sampling.h"

namespace alcove {
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
  const ChannelRef& ref = source[RawPlane::behind][plane];
  return fmt::format("{}: {}", source.files[ref.file].path(), ref.channel);
}

double percent(std::size_t part, std::size_t whole) { return 100.0 * double(part) / double(whole); }

}  // namespace

void BehindSample::add(const Reading& reading, std::span<const float> depth, std::span<const float> behind,
                       const Window& window, const Window& whole) {
  planes_.resize(reading.behind.size());
  if (planes_.empty()) return;
  const std::size_t pixels = window.pixels();
  taken_.resize(whole.pixels() / sampling_step(whole, kSampled) + 1);
  const View view = view_of(reading.camera, window, reading.display);
  const DepthMap own = depth_map_of(reading);
  const DepthPrecision precision = hidden_precision_of(reading);
  std::vector<DepthMap> maps;
  for (const auto& plane : reading.behind) maps.push_back(behind_map_of(reading, plane));
  for_each_sampled(view, depth, window, whole, kSampled, [&](const SampledPixel& pixel) {
    if (taken_[pixel.number]) return;
    taken_[pixel.number] = true;
    const double first = planar_depth(own, pixel.values, pixel.ray);
    const double width = std::abs(view.tangent_per_pixel.x) * (view.orthographic ? 1 : first);
    const double separation = kSameSurface * precision.at_depth(first) + width;
    for (std::size_t p = 0; p < planes_.size(); p++) {
      Plane& plane = planes_[p];
      const double raw = behind[pixel.at + p * pixels];
      if (raw < 0) plane.negative++;
      const double z = planar_depth(maps[p], {raw, 0, 0}, pixel.ray);
      if (!std::isfinite(first) || !std::isfinite(z)) continue;
      plane.surfaces++;
      if (reading.behind[p].kind == BehindKind::thickness) {
        plane.as_deep += z >= first - separation ? 1 : 0;
        continue;
      }
      const auto is_same = [&](double other) { return std::abs(z - other) <= separation; };
      plane.before += z < first - separation ? 1 : 0;
      plane.same += is_same(first) ? 1 : 0;
      bool is_known = is_same(first);
      for (std::size_t q = 0; q < p && !is_known; q++)
        is_known = reading.behind[q].kind == reading.behind[p].kind &&
                   is_same(planar_depth(maps[q], {behind[pixel.at + q * pixels], 0, 0}, pixel.ray));
      plane.known += is_known ? 1 : 0;
      plane.parts.push_back(float(z / first));
      if (pixel.ray < kOblique) continue;
      const double other = maps[p].along_ray ? z * pixel.ray : z / pixel.ray;
      plane.oblique++;
      plane.as_read += std::abs(z - first) < kEqual * first ? 1 : 0;
      plane.otherwise += std::abs(other - first) < kEqual * first ? 1 : 0;
    }
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
  if (source.deep && !planes_.empty() && new_surfaces == 0)
    notes.push_back({NoteCode::nothing_hidden,
                     fmt::format("{} holds no surface behind the first one: its elements were rendered in one go; give "
                                 "--deep all elements that were rendered apart, or give peels to --behind",
                                 source.files[*source.deep].path())});
  return notes;
}

Notes BehindSample::notes_of(const FrameSource& source, std::size_t number) const {
  const Plane& plane = planes_[number];
  const BehindPlane& said = source.behind[number];
  const std::string name = name_of(source, number);
  const auto pixels = std::size_t(std::ranges::count(taken_, true));
  if (said.kind == BehindKind::thickness && plane.negative > 0)
    fail(ErrorKind::input,
         "{} is below 0 on {:.2g} % of the pixels, and a thickness is how far a solid goes on behind its front: name "
         "another channel with --set behind-channel, or say with --behind-kind what it is",
         name, percent(plane.negative, pixels));
  if (plane.surfaces == 0)
    return {{NoteCode::empty_layer, fmt::format("{} shows no surface where the depth has one (--behind)", name)}};
  if (plane.surfaces < kLeastSurfaces) return {};
  if (said.kind == BehindKind::thickness) {
    if (double(plane.as_deep) < kAsDeep * double(plane.surfaces)) return {};
    return {{NoteCode::said_otherwise,
             fmt::format("{} is no less than the depth on {:.0f} % of the surfaces, and as a thickness it is added to "
                         "that: if it is the depth of back faces, give --behind-kind backs",
                         name, percent(plane.as_deep, plane.surfaces))}};
  }

  const bool along_ray = behind_map_of(source, said).along_ray;
  if (double(plane.otherwise) > kLeastOtherwise * double(plane.oblique) &&
      plane.otherwise > kFarMoreOtherwise * plane.as_read)
    fail(ErrorKind::input,
         "{} is the frame's own depth on {:.0f} % of the pixels if it is {}, and is read as {} like the depth of {}: "
         "write both alike, or name another channel with --set behind-channel; --depth-kind says how both are read",
         name, percent(plane.otherwise, plane.oblique), along_ray ? "planar" : "along the ray",
         along_ray ? "along the ray" : "planar", source.depth_path());
  if (double(plane.before) >= kRefused * double(plane.surfaces))
    fail(
        ErrorKind::input,
        "{} lies before the first surface on {:.0f} % of the pixels, at {:.3g} times its depth: it is of another frame "
        "or camera than the depth of {}, or has another scale or kind; give another file with --behind, name another "
        "channel with --set behind-channel, or say with --depth-kind and --depth-scale how both are read",
        name, percent(plane.before, plane.surfaces), median_of(plane.parts), source.depth_path());
  Notes notes;
  if (double(plane.before) > kNoted * double(plane.surfaces))
    notes.push_back({NoteCode::before_first,
                     fmt::format("{} lies before the first surface on {:.0f} % of the pixels, where it is left out: is "
                                 "it of the same frame and camera (--behind)?",
                                 name, percent(plane.before, plane.surfaces))});
  if (plane.same == plane.surfaces)
    notes.push_back({NoteCode::nothing_hidden,
                     fmt::format("{} is the first surface wherever it has one, and shows nothing new: name the channel "
                                 "of what lies behind with --set behind-channel, or give another file with --behind",
                                 name)});
  else if (plane.known == plane.surfaces)
    notes.push_back({NoteCode::nothing_hidden,
                     fmt::format("{} shows nothing new: what is given before it has all of its surfaces; name another "
                                 "channel with --set behind-channel, give another file, or leave it out (--behind)",
                                 name)});
  return notes;
}

}  // namespace alcove
