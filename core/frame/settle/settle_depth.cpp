// Settles depth: holds what is said of it against its pixels, and settles its sign, its ends, and the space of
// positions. Measures the rounding of values.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/pixels/findings.h"
#include "core/frame/pixels/flatness.h"
#include "core/frame/pixels/ramps.h"
#include "core/frame/pixels/walk.h"
#include "core/frame/samples.h"
#include "core/frame/settle/settlement.h"

namespace alcove {
namespace {

/// All pixels of a picture are looked at if it has fewer than these.
constexpr std::size_t kFewPixels = 100'000;

Side side_of(std::vector<float> values) {
  Side side{values.size(), values.size()};
  std::ranges::sort(values);
  for (auto first = values.begin(); first != values.end();) {
    const auto next = std::upper_bound(first, values.end(), *first);
    const std::size_t others = values.size() - std::size_t(next - first);
    if (others < side.others) side.others = others, side.usual = *first;
    first = next;
  }
  return side;
}

/// The options of a range that depth of this kind has not.
std::vector<std::string> unused_range_options(const DepthRange& said, DepthKind kind) {
  const bool is_device = kind == DepthKind::device, is_log = kind == DepthKind::log;
  const bool is_disparity = kind == DepthKind::disparity, has_planes = is_disparity || is_between_planes(kind);
  std::vector<std::string> unused;
  if (said.near && (is_log || !has_planes)) unused.emplace_back("--near");
  if (said.far && !has_planes) unused.emplace_back("--far");
  if (said.disparity_scale && !is_disparity) unused.emplace_back("--set disparity-scale");
  if (said.disparity_shift && !is_disparity) unused.emplace_back("--set disparity-shift");
  if (said.reversed && !is_between_planes(kind)) unused.emplace_back("--reversed-z");
  if (said.device != DeviceRange::automatic && !is_device) unused.emplace_back("--set device-range");
  if (said.log_constant != DepthRange{}.log_constant && !is_log) unused.emplace_back("--set log-constant");
  return unused;
}

/// Refuses options of the user for a range that depth of this kind lacks. Presets serve frames of every kind.
void refuse_unused_range(const PlanesToSettle& planes) {
  const DepthKind kind = planes.reading.depth_kind;
  auto unused = unused_range_options(planes.settings.depth_range, kind);
  std::erase_if(unused, [&](const auto& option) { return planes.settings.from_presets.contains(option); });
  if (unused.empty()) return;
  const bool is_one = unused.size() == 1;
  fail(ErrorKind::usage,
       "{}: {} {} no effect, since the depth is read as {}: leave {} out, or give the depth's kind with --depth-kind",
       planes.path, fmt::join(unused, ", "), is_one ? "has" : "have", word_of(kind), is_one ? "it" : "them");
}

/// Depth that is no position: decides its kind, or holds the one that is said against its pixels, and settles its ends.
class PlaneSettlement : private DepthSettlement {
 public:
  explicit PlaneSettlement(const DepthSettlement& depth) : DepthSettlement(depth) {}

  void run() {
    facts_.is_kind_open ? settle_depth_kind(*this) : doubt_kind();
    compare_near_planes();
    settle_sign();
    settle_ends();
    find_sky();
  }

 private:
  /// Notes evidence of the pixels, or of two sources of planes, against the given kind of depth. The given kind stays.
  void doubt_kind() {
    doubt_range();
    const bool linear = reading_.depth_kind == DepthKind::normalized || reading_.depth_kind == DepthKind::log;
    const DepthKind said = reading_.depth_kind == DepthKind::disparity ? DepthKind::inverse  // with a shift, alike
                           : reading_.depth_kind != DepthKind::device  ? reading_.depth_kind
                           : reading_.camera.orthographic              ? DepthKind::planar
                                                                       : DepthKind::inverse;
    const auto& scores = seen_.depth_scores;
    doubt_fractions(scores);
    if (scores.empty() || scores[0].straight < (linear ? kSurelyStraight : kLeastStraight)) return;
    if (kClear * straightness(linear ? scores_as_said() : scores, linear ? DepthKind::planar : said) >
        scores[0].straight)
      return;
    note(NoteCode::said_otherwise,
         fmt::format("depth is read as {} by {}, but {}: is it {}?", word_of(reading_.depth_kind), facts_.said_by,
                     straight(scores[0]),
                     scores[0].kind == DepthKind::inverse ? "inverse or device" : word_of(scores[0].kind)));
  }

  /// Notes near planes that differ. A projection matrix made for another depth range than the buffer's scales all
  /// distances, which no pixel shows.
  void compare_near_planes() {
    constexpr double kSame = 0.01;  // matrices are rounded
    const auto near = reading_.depth_range.near, by_file = reading_.camera.near,
               by_matrix = reading_.camera.matrix_near;
    const bool is_said = settings_.depth_range.near.has_value();
    if (reading_.depth_kind != DepthKind::device) return;
    if (is_said && by_file && std::abs(*near / *by_file - 1) >= kSame)
      note(NoteCode::near_plane, fmt::format("--near is {:.4g}, and the camera file's near plane is at {:.4g}: "
                                             "distances are {:.3g} times those by the file",
                                             *near, *by_file, *near / *by_file));
    if (is_said || reading_.depth_range.reversed || reading_.depth_range.device != DeviceRange::automatic) return;
    if (!near || !by_matrix || std::abs(*by_matrix / *near - 1) < kSame) return;
    note(NoteCode::near_plane,
         fmt::format("the near plane is {:.4g}, but the camera file's projection, read with z = depth, has it at "
                     "{:.4g}, for distances {:.3g} times as large; --near or --set device-range decides",
                     *near, *by_matrix, *by_matrix / *near));
  }

  /// Notes distances that look like a part of a range. They are read as distances all the same.
  void doubt_fractions(const std::vector<DepthScore>& scores) {
    if (!is_distance(reading_.depth_kind) || !is_fraction()) return;
    const double straight = scores.empty() ? 0 : scores[0].straight, from_1 = straightness_from_1();
    if (from_1 >= kLeastStraight && from_1 > kClear * straight)
      note(NoteCode::said_otherwise,
           fmt::format("{}, and flat surfaces are straight on {:.0f} % as 1 - depth, on {:.0f} % as depth: it is read "
                       "as {} by {}; if it is normalized, give {}",
                       text_of_range(), 100 * from_1, 100 * straight, word_of(reading_.depth_kind), facts_.said_by,
                       normalized_line(true)));
    else if (settings_.depth_kind == DepthKind::automatic && facts_.program.rules->depth_kind == DepthKind::automatic)
      note(NoteCode::depth_below_1,
           fmt::format("{} and is read as {}; if it is normalized, give {}; --depth-kind {} confirms distances",
                       text_of_range(), word_of(reading_.depth_kind), normalized_line(false),
                       word_of(reading_.depth_kind)));
  }

  /// The scores of the distances that the depth gives if it is read as is said.
  std::vector<DepthScore> scores_as_said() const {
    const auto planar = planar_depths(raw_.depth, depth_map_of(reading_), view_);
    return shape_of(planar, view_, settings_.sky, grain_of(planar, settings_.sky, view_.orthographic != 0)).scores;
  }

  /// Notes a z-buffer that uses only half of its range, or that leaves it.
  void doubt_range() {
    if (reading_.depth_kind != DepthKind::device) return;
    const auto below = std::ranges::count_if(raw_.depth, [](float d) { return d > -1 && d < 0; });
    if (reading_.depth_range.device == DeviceRange::automatic && below > 0)
      note(NoteCode::said_otherwise,
           fmt::format(
               "{} pixels have a depth of -1 to 0 and count as sky: does the depth need --set device-range=-1..1?",
               below));
    if (reading_.depth_range.device == DeviceRange::minus_one_to_one && values_.all.least >= 0)
      note(NoteCode::said_otherwise,
           "no depth is below 0: either all surfaces lie beyond twice the near plane, or --set device-range=-1..1 is "
           "wrong");
  }

  /// Distances below 0 are those of cameras that look along -z. One value above 0 beside them is their sky.
  void settle_sign() {
    if (!is_distance(reading_.depth_kind) && reading_.depth_kind != DepthKind::inverse) return;
    const bool are_errors =
        double(values_.below_0.count) <= kFewErrors * double(values_.below_0.count + values_.above_0.size());
    if (!values_.below_0.varies() || are_errors) return;
    const Side above = values_.side_above(0);
    if (!above.is_mostly_one()) return;
    reading_.depth_range.negative = true;
    note(NoteCode::negative_depth,
         above.count ? fmt::format("depth is negative, and its distance from 0 is taken; {} is the sky", above.usual)
                     : "all depth values are negative: their distance from 0 is the depth");
  }

  /// Settles depth at the ends of a range and beyond them: normalized depth may go on, and the sky is at the far end.
  void settle_ends() {
    auto& range = reading_.depth_range;
    if (reading_.depth_kind == DepthKind::normalized) {
      const bool below = goes_on(values_.below_0, values_.all.zero, 0),
                 above = goes_on(values_.side_above(1), values_.all.one, 1);
      range.goes_before_near = range.reversed ? above : below;
      range.goes_beyond_far = range.reversed ? below : above;
      if (below || above)
        note(NoteCode::beyond_planes,
             fmt::format("depth goes from {:.3g} to {:.3g}: it was not cut off at its planes, and is read beyond them",
                         values_.all.least, values_.surfaces.most));
    }
    if (reading_.depth_kind == DepthKind::device) settle_direction();
  }

  /// Whether normalized depth goes on beyond an end of its range. If many pixels are exactly at the end, it was cut off
  /// there: a filter made the values beyond from the edges of these, and they count as these do.
  bool goes_on(const Side& beyond, std::uint64_t at_end, int end) {
    if (!beyond.varies()) return false;
    if (double(at_end) < kPlateau * double(values_.all.pixels)) return true;
    if (double(beyond.count) > kFewErrors * double(values_.all.pixels))
      note(NoteCode::beyond_planes,
           fmt::format("{:.2g} % of the depth lies beyond {}, and {:.2g} % is exactly {}: all of these count as sky",
                       100 * double(beyond.count) / double(values_.all.pixels), end,
                       100 * double(at_end) / double(values_.all.pixels), end));
    return false;
  }

  /// Nothing is seen at exactly the near plane, so that many pixels there are sky of a depth that runs the other way.
  void settle_direction() {
    auto& range = reading_.depth_range;
    const float low = range.device == DeviceRange::minus_one_to_one ? -1 : 0, near = range.reversed ? 1 : low,
                far = range.reversed ? low : 1;
    const auto at_near = std::size_t(std::ranges::count(raw_.depth, near));
    if (double(at_near) < kPlateau * double(raw_.depth.size()) ||
        std::ranges::find(raw_.depth, far) != raw_.depth.end())
      return;
    const std::string what = fmt::format(
        "{:.0f} % of the pixels have exactly {}, the near plane's value{}, and none has {}",
        100 * double(at_near) / double(raw_.depth.size()), near, range.reversed ? " of reversed depth" : "", far);
    const bool is_by_rules = !settings_.depth_range.reversed && !reading_.camera.reversed_z && range.reversed;
    if (!is_by_rules) {
      note(NoteCode::said_otherwise,
           fmt::format("{}: that looks like the sky of depth that is {}reversed: {} --reversed-z", what,
                       range.reversed ? "not " : "", range.reversed ? "leave out" : "give"));
      return;
    }
    range.reversed = false;
    guess("depth's direction", "not reversed", what, "--reversed-z", true);
  }

  /// Takes one distance far behind all others for the sky where the normals show it, and else points it out.
  void find_sky() {
    constexpr double kLeastShare = 0.002;  // of the pixels
    constexpr double kBlended = 0.1;       // for each pixel of the sky; edges lie in between
    if (!is_distance(reading_.depth_kind) || settings_.sky != InputSettings{}.sky) return;
    const Farthest far = farthest();
    const double share = double(far.count) / double(far.all);
    if (far.next == 0 || share < kLeastShare || double(far.blended) > kBlended * double(far.count)) return;
    // A wall that faces the camera has one planar depth and one normal; a dome around it has many normals.
    if (reading_.depth_kind == DepthKind::planar && far.like_first == far.count) return;
    if (far.is_bare()) reading_.found_sky = far.value;
    note(NoteCode::finite_sky, far.is_bare()
                                   ? fmt::format("the depth {:.6g} of {:.1f} % of the pixels, all without normals, is "
                                                 "taken for the sky (--sky {:.6g} confirms it)",
                                                 far.value, 100 * share, far.value)
                                   : fmt::format("{:.1f} % of the pixels have exactly the depth {:.6g}, and all others "
                                                 "end at {:.4g}: if they are sky, and no wall, give --sky {:.6g}",
                                                 100 * share, far.value, far.next, far.value));
  }

  /// The pixels with the largest distance, and all others.
  struct Farthest {
    float value = 0, next = 0;             // next: the largest distance that is less than half of it
    std::size_t all = 0, count = 0;        // pixels that were looked at, and those with it
    std::size_t blended = 0;               // surfaces in between
    std::size_t bare = 0, other_bare = 0;  // without a normal: those with it, and other surfaces
    std::size_t like_first = 0;            // with the normal of the first one
    bool has_normals = false;

    /// Whether these pixels, and no others, have no normals.
    bool is_bare() const {
      constexpr double kAll = 0.98;
      return has_normals && double(bare) >= kAll * double(count) &&
             double(other_bare) <= (1 - kAll) * double(all - count);
    }
  };

  Farthest farthest() const {
    constexpr std::size_t kSampled = 1 << 15;
    constexpr double kFar = 2;  // times as far as all others
    const double limit = depth_map_of(reading_).sky_depth / reading_.depth_scale;
    const std::size_t step = raw_.depth.size() / kSampled + 1;
    Farthest far{.has_normals = has_vectors()};
    for (std::size_t i = 0; i < raw_.depth.size(); i += step)
      if (const float d = std::abs(raw_.depth[i]); d < limit) far.value = std::max(far.value, d);
    std::optional<std::size_t> first;
    for (std::size_t i = 0; i < raw_.depth.size(); i += step) {
      const float d = std::abs(raw_.depth[i]);
      const bool is_bare = far.has_normals && has_no_normal(i);
      far.all++;
      if (d == far.value) {
        if (!first) first = i;
        far.count++;
        far.bare += is_bare;
        far.like_first += far.has_normals && !is_bare && has_same_normal(i, *first);
      } else if (d > 0 && d < limit) {
        far.other_bare += is_bare;
        kFar* d >= far.value ? void(far.blended++) : void(far.next = std::max(far.next, d));
      }
    }
    return far;
  }

  bool has_same_normal(std::size_t pixel, std::size_t other) const {
    constexpr float kRounded = 0.01f;  // 8 bits, too
    for (std::size_t c = 0; c < 3; c++) {
      const float* const plane = &raw_.normal[c * raw_.depth.size()];
      if (!(std::abs(plane[pixel] - plane[other]) < kRounded)) return false;
    }
    return true;
  }

  /// Whether a pixel's normal is NaN, or 0 as a vector or as a colour.
  bool has_no_normal(std::size_t pixel) const {
    constexpr float kGrey = 0.5f, kRoundedGrey = 0.003f;  // 8 bits have no 0.5
    const auto all = [&](const auto& holds) {
      for (std::size_t c = 0; c < 3; c++)
        if (!holds(raw_.normal[c * raw_.depth.size() + pixel])) return false;
      return true;
    };
    return all([](float n) { return n == 0; }) || all([](float n) { return std::isnan(n); }) ||
           all([](float n) { return std::abs(n - kGrey) < kRoundedGrey; });
  }
};

/// Pixels. If the median is farther off than this, positions are no positions of this space and camera.
constexpr double kLargestError = 2;

/// Settles the space of positions.
class PositionSettlement : private Settlement {
 public:
  using Settlement::Settlement;

  void run() {
    struct Candidate {
      PositionSpace space;
      bool forward;  // the camera looks along +z
      std::optional<double> error;
    };
    std::vector<Candidate> candidates;
    for (const PositionSpace space : {PositionSpace::world, PositionSpace::view})
      for (const bool forward : {false, true})
        if ((settings_.position_space == PositionSpace::automatic || settings_.position_space == space) &&
            (space == PositionSpace::view || (reading_.camera.view_from_world && !forward)))
          candidates.push_back(
              {space, forward, reprojection_error(raw_.depth, space, forward, reading_.camera, view_)});
    // no world matrix, which the map complains about; or nothing but sky
    if (candidates.empty() || !candidates[0].error) return;
    const auto best = std::ranges::min_element(candidates, {}, &Candidate::error);
    if (!(*best->error <= kLargestError))
      fail(
          ErrorKind::input, "{}: its positions lie {} from their pixels: check --set position-space and --camera",
          path_,
          *best->error < 1e6 ? fmt::format("{:.1f} pixels (median)", *best->error) : "on the other side of the camera");
    reading_.position_space = best->space;
    reading_.depth_range.negative = best->forward;
    if (settings_.position_space == PositionSpace::automatic)
      guess("position space", best->space == PositionSpace::world ? "world" : "view",
            fmt::format("positions lie {:.3f} pixels (median) from their pixels", *best->error), "--set position-space",
            false);
  }
};

}  // namespace

DepthValues::DepthValues(std::span<const float> depth, double sky)
    : step(depth.size() < kFewPixels ? 1 : kSparse), all(statistics_of(depth, step)) {
  std::vector<float> below;
  for (std::size_t i = 0; i < depth.size(); i += step)
    if (std::isfinite(depth[i]) && depth[i] != 0 && std::abs(depth[i]) < sky)
      (depth[i] < 0 ? below : above_0).push_back(depth[i]);
  has_any = !below.empty() || !above_0.empty();
  surfaces = statistics_of(above_0);
  below_0 = side_of(std::move(below));
}

Side DepthValues::side_above(float limit) const {
  std::vector<float> above;
  std::ranges::copy_if(above_0, std::back_inserter(above), [&](float d) { return d > limit; });
  return side_of(std::move(above));
}

double DepthSettlement::straightness_from_1() const {
  std::vector<float> turned(raw_.depth.begin(), raw_.depth.end());
  for (float& d : turned) d = d > 0 && d < 1 ? 1 - d : 0;
  return straightness(shape_of(turned, view_, settings_.sky, seen_.grain).scores, DepthKind::planar);
}

void settle_depth(const PlanesToSettle& planes, const DepthFacts& facts) {
  const auto depth = planes.raw.depth;
  const double sky = planes.settings.sky;
  const DepthValues values(depth, sky);
  planes.seen.tells = values.has_any;
  if (planes.reading.depth_kind == DepthKind::position) {
    PositionSettlement(planes).run();
  } else {
    DepthShape shape = shape_of(depth, view_of(planes.reading, planes.raw.window), sky, planes.seen.grain);
    planes.seen.depth_scores = std::move(shape.scores);
    planes.seen.curve = shape.curve;
    const DepthSettlement depth(planes, facts, values);
    if (planes.reading.depth_kind == DepthKind::disparity) settle_disparity(depth);
    PlaneSettlement(depth).run();
  }
  refuse_unused_range(planes);
}

// Measures of the pixels.

namespace {

/// Refuses depth that was saved as a grey picture: it has no more than 256 distances.
void refuse_8_bits(std::span<const float> depth, const std::string& name) {
  constexpr std::size_t kLeastLevels = 16;  // fewer may be a few walls that happen to lie there
  std::set<double> levels;
  for (std::size_t i = 0; i < depth.size(); i += kSparse) {
    const double level = 255.0 * depth[i];
    if (!(level >= 0 && level <= 255) || std::abs(level - std::round(level)) > 1e-4) return;
    levels.insert(std::round(level));
  }
  if (levels.size() >= kLeastLevels)
    fail(ErrorKind::input,
         "{} holds only values of 8 bits, too few distances for AO: give --depth as floats, in EXR or DDS{}", name,
         kDisparityHint);
}

Overflow overflow_of(const Reading& reading, std::span<const float> depth) {
  constexpr float kNear = 0.9f * float(kLargestHalf);
  if (!is_distance(reading.depth_kind) || !(reading.depth_is_half || reading.found_sky == kLargestHalf)) return {};
  std::size_t beyond = 0;
  bool is_reached = false;
  for (const float d : depth) {
    beyond += std::abs(d) >= kLargestHalf;
    is_reached |= std::abs(d) >= kNear && std::abs(d) < kLargestHalf;
  }
  return {double(beyond) / double(depth.size()), is_reached};
}

/// Whether most values are below 0 and are not read as distances from it.
bool begins_behind(const Reading& reading, std::span<const float> depth) {
  std::size_t below = 0, all = 0;
  for (std::size_t i = 0; i < depth.size(); i += kSparse) all++, below += depth[i] < 0;
  return !reading.depth_range.negative && 2 * below > all;
}

}  // namespace

Grain measure_rounding(Reading& reading, const Window& window, std::span<const float> depth, const std::string& name) {
  reading.depth_is_coarse = false;
  if (depth.size() != window.pixels()) return {};
  if (reading.depth_kind != DepthKind::disparity) refuse_8_bits(depth, name);
  const Grain grain = grain_of(depth, reading.sky, reading.camera.orthographic);
  reading.depth_is_coarse = grain.is_coarse;
  const auto is_beyond = [&](float d) { return std::abs(d) > kLargestHalf && std::abs(d) < reading.sky; };
  if (grain.is_half && std::ranges::none_of(depth, is_beyond)) reading.found_sky = kLargestHalf;
  if (grain.is_coarse && grain.is_fixed)
    reading.depth_step = grain.step;
  else if (grain.is_coarse)
    reading.depth_rounding =
        grain.is_half ? kHalfPrecision : 0.5 * std::exp2(std::ceil(std::log2(grain.step / grain.median)));
  return grain;
}

void measure_levels(Reading& reading, std::span<const float> depth) {
  if (is_between_planes(reading.depth_kind) || reading.depth_kind == DepthKind::disparity)
    reading.depth_step = std::max(reading.depth_step, step_of(depth));
}

Findings findings_of(const Reading& frame, const RawPart& raw, const Evidence& seen, const std::string& name,
                     bool has_read_normals) {
  const Reading reading = over(frame, raw.window);
  Findings found{.depth_channel = name,
                 .depth_kind = reading.depth_kind,
                 .has_half_type = reading.depth_is_half,
                 .grain = seen.grain,
                 .curve = seen.curve,
                 .begins_behind = begins_behind(reading, raw.depth),
                 .said_offset = said_offset(reading),
                 .overflow = overflow_of(reading, raw.depth)};
  if (reading.depth_kind == DepthKind::disparity)
    found.above_shift = seen.grain.median - reading.depth_range.disparity_shift.value_or(0);
  found.jitter = jitter_of(raw.depth, depth_map_of(reading), view_of(reading, raw.window), seen.grain);
  if (raw.window == frame.data && raw.depth.size() == raw.window.pixels())
    found.borders = borders_of(raw.depth, raw.window, depth_map_of(reading));
  const std::vector<float> cut = with_ramps_cut(reading, raw.depth);
  for (std::size_t i = 0; i < cut.size(); i++) found.cut_pixels += !std::isnan(cut[i]) && cut[i] != raw.depth[i];
  walk({reading, frame.data, reading.cuts_ramps ? std::span(cut) : raw.depth, raw.normal, has_read_normals}, found);
  return found;
}

}  // namespace alcove
