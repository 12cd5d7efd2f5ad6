// Scores the ways in which a frame's depth may be read, and chooses one.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/evidence.h"
#include "core/frame/settle/settlement.h"

namespace alcove {
namespace {

/// If a smaller part of the smooth places is straight, the frame has no flat surfaces that could tell.
constexpr double kLeastStraight = 0.02;
/// From this part of the smooth places on, flat surfaces speak for a kind by themselves.
constexpr double kSurelyStraight = 0.1;
/// If this part of the pixels is exactly 1, that is a background.
constexpr double kPlateau = 0.001;
/// A range of 0 to 1 may exceed 1 by so much because it was computed.
constexpr double kRounded = 1e-3;
/// If a smaller part of the values lies on the other side of 0, or none of them is so far from it as rounding may
/// bring them, these are errors.
constexpr double kFewErrors = 0.005;
/// The normals decide between distances and 1/z if so many times as many agree with one of them.
constexpr double kClearNormals = 1.5;
/// All pixels of a picture are looked at if it has fewer than these.
constexpr std::size_t kFewPixels = 100'000;
/// Pixels. If the median is farther off than this, positions are no positions of this space and camera.
constexpr double kLargestError = 2;

/// The values on one side of a limit. One value alone stands for something that is no surface.
struct Side {
  std::size_t count = 0, others = 0;  // others: all but the most frequent value
  float usual = 0;                    // the most frequent value

  bool varies() const { return others > 0; }
  /// Edges blend one value with others.
  bool is_mostly_one() const { return 10 * others <= count; }
};

/// Sorts the values.
Side side_of(std::vector<float>& values) {
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

class DepthSettlement : private Settlement {
 public:
  DepthSettlement(const PlanesToSettle& planes, const DepthFacts& facts)
      : Settlement(planes),
        facts_(facts),
        usual_(facts.program.depth_kind),
        step_(raw_.depth.size() < kFewPixels ? 1 : kSparse),
        values_(statistics_of(raw_.depth, step_)) {
    const auto& depth = raw_.depth;
    std::vector<float> below_0, above_0;
    for (std::size_t i = 0; i < depth.size(); i += step_)
      if (std::isfinite(depth[i]) && depth[i] != 0 && std::abs(depth[i]) < settings_.sky)
        (depth[i] < 0 ? below_0 : above_0).push_back(depth[i]);
    surfaces_ = statistics_of(above_0);
    below_0_ = side_of(below_0);
    above_0_ = side_of(above_0);
    above_0.erase(above_0.begin(), std::ranges::upper_bound(above_0, 1.0f));
    above_1_ = side_of(above_0);
  }

  void run() {
    const auto is_near = [&](std::size_t i) {
      return std::isfinite(raw_.depth[i]) && raw_.depth[i] != 0 && std::abs(raw_.depth[i]) < settings_.sky;
    };
    seen_.tells = false;
    for (std::size_t i = 0; i < raw_.depth.size() && !seen_.tells; i += step_) seen_.tells = is_near(i);
    if (reading_.depth_kind == DepthKind::position)
      settle_position();
    else
      settle_plane();
    refuse_unused_range();
  }

 private:
  void settle_plane() {
    seen_.depth_scores = score_depth(raw_.depth, view_, settings_.sky, seen_.grain);
    if (facts_.is_kind_open)
      settle_kind();
    else
      doubt_kind();
    compare_planes();
    settle_sign();
    settle_ends();
    find_sky();
  }

  /// Distances below 0 are those of cameras that look along -z. One value above 0 beside them is their sky.
  void settle_sign() {
    if (!is_distance(reading_.depth_kind) && reading_.depth_kind != DepthKind::inverse) return;
    const bool are_errors = double(below_0_.count) <= kFewErrors * double(below_0_.count + above_0_.count);
    if (!below_0_.varies() || are_errors || !above_0_.is_mostly_one()) return;
    reading_.depth_range.negative = true;
    note(NoteCode::negative_depth,
         above_0_.count
             ? fmt::format("depth is negative, and its distance from 0 is taken; {} is the sky", above_0_.usual)
             : "all depth values are negative: their distance from 0 is the depth");
  }

  /// Fails with values on both sides of 0, which are no distances.
  void refuse_signs() const {
    const std::size_t fewer = std::min(below_0_.count, above_0_.count), all = below_0_.count + above_0_.count;
    const bool is_error =
        double(fewer) <= kFewErrors * double(all) ||
        std::min(-values_.least, surfaces_.most) <= kRounded * std::max(-values_.least, surfaces_.most);
    if (!below_0_.varies() || above_0_.is_mostly_one() || is_error) return;
    fail(ErrorKind::input,
         "{}: depth goes from {:.3g} to {:.3g}, {:.0f} % of it below 0, so these are no distances: if it is normalized "
         "and goes on beyond its planes, as V-Ray writes it without clamp, give --depth-kind normalized --near N --far "
         "F, the distances of 0 and of 1 (with --reversed-z, of 1 and of 0); if values below 0 are no surfaces, give "
         "--depth-kind planar",
         path_, values_.least, surfaces_.most, 100 * double(below_0_.count) / double(all));
  }

  /// Settles depth at the ends of a range and beyond them: normalized depth may go on, and the sky is at the far end.
  void settle_ends() {
    auto& range = reading_.depth_range;
    if (reading_.depth_kind == DepthKind::normalized) {
      const bool below = goes_on(below_0_, values_.zero, 0), above = goes_on(above_1_, values_.one, 1);
      range.goes_before_near = range.reversed ? above : below;
      range.goes_beyond_far = range.reversed ? below : above;
      if (below || above)
        note(NoteCode::beyond_planes,
             fmt::format("depth goes from {:.3g} to {:.3g}: it was not cut off at its planes, and is read beyond them",
                         values_.least, surfaces_.most));
    }
    if (reading_.depth_kind == DepthKind::device) settle_direction();
  }

  /// Whether normalized depth goes on beyond an end of its range. If many pixels are exactly at the end, it was cut off
  /// there: a filter made the values beyond from the edges of these, and they count as these do.
  bool goes_on(const Side& beyond, std::uint64_t at_end, int end) {
    if (!beyond.varies()) return false;
    if (double(at_end) < kPlateau * double(values_.pixels)) return true;
    if (double(beyond.count) > kFewErrors * double(values_.pixels))
      note(NoteCode::beyond_planes,
           fmt::format("{:.2g} % of the depth lies beyond {}, and {:.2g} % is exactly {}: what lies beyond counts as "
                       "that, the sky",
                       100 * double(beyond.count) / double(values_.pixels), end,
                       100 * double(at_end) / double(values_.pixels), end));
    return false;
  }

  /// Nothing is seen at exactly the near plane, so that many pixels there are sky of a depth that runs the other way.
  void settle_direction() {
    auto& range = reading_.depth_range;
    const float low = range.device == DeviceRange::zero_to_one ? 0 : -1, near = range.reversed ? 1 : low,
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
    constexpr std::size_t kSampled = 1 << 16;
    constexpr double kLeastShare = 0.002;  // of the pixels
    constexpr double kFar = 2;             // times as far as all others
    constexpr double kAll = 0.98;          // of the pixels of the sky have no normal, and of the others have one
    constexpr double kBlended = 0.1;       // for each pixel of the sky; edges lie in between
    if (!is_distance(reading_.depth_kind) || settings_.sky != InputSettings{}.sky) return;
    const double limit = depth_map_of(reading_).sky_depth / reading_.depth_scale;
    const std::size_t step = raw_.depth.size() / kSampled + 1;
    float most = 0, next = 0;
    for (std::size_t i = 0; i < raw_.depth.size(); i += step)
      if (const float d = std::abs(raw_.depth[i]); d < limit) most = std::max(most, d);
    std::size_t count = 0, all = 0, bare = 0, others_bare = 0, blended = 0, like_first = 0;
    std::optional<std::size_t> first;  // pixel of the sky
    const bool has_normals = raw_.normal.size() == 3 * raw_.window.pixels();
    for (std::size_t i = 0; i < raw_.depth.size(); i += step) {
      const float d = std::abs(raw_.depth[i]);
      const bool is_sky = d == most, is_surface = !is_sky && d > 0 && d < limit;
      if (is_surface && kFar * d >= most)
        blended++;
      else if (is_surface)
        next = std::max(next, d);
      const bool is_bare = has_normals && has_no_normal(i);
      all++, count += is_sky, bare += is_sky && is_bare, others_bare += is_surface && is_bare;
      if (is_sky && !first) first = i;
      like_first += is_sky && has_normals && !is_bare && has_same_normal(i, *first);
    }
    const double share = double(count) / double(all);
    if (next == 0 || share < kLeastShare || double(blended) > kBlended * double(count)) return;
    // A wall that faces the camera has one planar depth and one normal; a dome around it has many normals.
    if (reading_.depth_kind == DepthKind::planar && like_first == count) return;
    const bool is_shown =
        has_normals && double(bare) >= kAll * double(count) && double(others_bare) <= (1 - kAll) * double(all - count);
    if (is_shown) reading_.found_sky = most;
    note(NoteCode::finite_sky,
         is_shown
             ? fmt::format("the depth {:.6g} of {:.1f} % of the pixels, which have no normals, is taken for the sky "
                           "(--sky {:.6g} says it)",
                           most, 100 * share, most)
             : fmt::format("{:.1f} % of the pixels have exactly the depth {:.6g}, and all others end at {:.4g}: if "
                           "that is the sky, and no wall, give --sky {:.6g}",
                           100 * share, most, next, most));
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

  /// Refuses options of the user for a range that depth of this kind lacks. Presets serve frames of every kind.
  void refuse_unused_range() const {
    auto unused = unused_range_options(settings_.depth_range, reading_.depth_kind);
    const auto& left_out = settings_.from_presets;
    std::erase_if(unused, [&](const auto& option) { return std::ranges::find(left_out, option) != left_out.end(); });
    if (!unused.empty()) refuse_range_options(path_, unused, reading_.depth_kind);
  }

  std::string straight(const DepthScore& score) const {
    return fmt::format("as {} alone {:.0f} % of the smooth places are flat", word_of(score.kind), 100 * score.straight);
  }

  /// Reads the depth as the program that wrote the frame, or most programs, write it. It is no guess where the user
  /// named the program.
  void take_usual(const std::string& why) {
    reading_.depth_kind = usual_;
    const std::string by = facts_.program.by.empty()
                               ? ""
                               : fmt::format("{} writes it ({}); ", facts_.program.rules->name, facts_.program.by);
    guess("depth kind", word_of(reading_.depth_kind), by + why, "--depth-kind", false);
  }

  /// Decides an open kind: by flat surfaces, else by positions, else by normals, else by the program, else the usual
  /// one.
  void settle_kind() {
    if (is_between_planes(usual_) && values_.least >= 0 && values_.most <= 1) return take_usual("all in 0 to 1");
    if (is_between_planes(usual_)) usual_ = reading_.depth_kind = DepthKind::planar;
    refuse_signs();
    const auto& scores = seen_.depth_scores;
    const bool tells = !scores.empty() && scores[0].straight >= kLeastStraight;
    if (!tells) seen_.tells = false;
    if (tells || usual_ != DepthKind::inverse) refuse_fractions(scores);
    if (tells) return take_flattest(scores);
    const std::string why = scores.empty() ? "too little of the frame is smooth to tell"
                                           : "the frame has no flat surfaces that tell: " + text_of(scores);
    if (take_by_positions(why) || take_by_normals(why)) return;
    if (usual_ == DepthKind::inverse) return assume_passed_on(why);
    take_usual(why);
    if (!facts_.program.is_said() || facts_.program.rules->depth_kind == DepthKind::automatic) note_assumption(why);
  }

  /// Takes the kind by which most surfaces are flat.
  void take_flattest(const std::vector<DepthScore>& scores) {
    const auto& expected = *std::ranges::find(scores, usual_, &DepthScore::kind);
    const std::string why = text_of(scores);
    const DepthScore &best = scores[0], &second = scores[1];
    if (usual_ == DepthKind::inverse) return take_passed_on(best.kind, why);
    if (expected.straight >= kAsGood * best.straight) return take_usual(why);
    if (best.straight < kClear * second.straight)
      fail(ErrorKind::input, "{}: the depth may be {} or {} ({}): say which with --depth-kind {} or --depth-kind {}",
           path_, word_of(best.kind), word_of(second.kind), why, word_of(best.kind), word_of(second.kind));
    reading_.depth_kind = best.kind;
    if (best.kind == DepthKind::inverse && values_.least >= 0 && is_fraction()) return settle_device(why);
    // A plane's distances are affine in the picture without perspective.
    const bool may_be_orthographic = best.kind == DepthKind::inverse && (settings_.fov || settings_.focal);
    guess("depth kind", word_of(best.kind),
          why + (may_be_orthographic
                     ? "; distances of an orthographic camera would look the same: give --ortho-width for one"
                     : ""),
          "--depth-kind", true);
  }

  /// Takes the kind by which the depth is that of the positions beside it. False: none.
  bool take_by_positions(const std::string& but) {
    const auto kind = facts_.kind_by_positions ? facts_.kind_by_positions() : std::nullopt;
    if (!kind) return false;
    reading_.depth_kind = *kind;
    guess("depth kind", word_of(*kind), "so it is that of the positions; " + but, "--depth-kind",
          *kind != usual_ && usual_ != DepthKind::inverse);
    return true;
  }

  /// Takes distances or 1/z, by which clearly more of the normals agree with depth. False: neither.
  bool take_by_normals(const std::string& but) {
    const double inverse = agreement_as(DepthKind::inverse), planar = agreement_as(DepthKind::planar);
    const double most = std::max(inverse, planar), least = std::min(inverse, planar);
    if (most < kLeastAgreement || most < kClearNormals * least) return false;
    const std::string why =
        fmt::format("{:.0f} % of the normals agree with 1/z, {:.0f} % with z; {}", 100 * inverse, 100 * planar, but);
    const DepthKind distance = usual_ == DepthKind::ray ? usual_ : DepthKind::planar;
    const DepthKind kind = inverse > planar ? DepthKind::inverse : distance;
    if (usual_ == DepthKind::inverse) {
      take_passed_on(kind, why);
    } else {
      reading_.depth_kind = kind;
      guess("depth kind", word_of(kind), why, "--depth-kind", kind != usual_);
    }
    return true;
  }

  /// Takes depth of a program that writes 1/z itself and passes on depth of other programs. Neither is unusual.
  void take_passed_on(DepthKind kind, const std::string& why) {
    reading_.depth_kind = kind;
    guess("depth kind", word_of(kind),
          fmt::format("{} ({}) writes 1/z, and passes on what others wrote; {}", facts_.program.rules->name,
                      facts_.program.by, why),
          "--depth-kind", false);
  }

  void assume_passed_on(const std::string& why) {
    if (is_fraction())
      fail(ErrorKind::input,
           "{}: {}, and neither flat surfaces nor normals tell whether it is 1/z, as {} writes it: give --depth-kind "
           "inverse; if it is normalized, {}",
           path_, text_of_range(), facts_.program.rules->name, normalized_line(false));
    take_passed_on(DepthKind::planar, why + ", and it holds more than 1");
    note_assumption(why);
  }

  /// Says of a kind that it is a guess.
  void note_assumption(const std::string& why) {
    note(NoteCode::assumed_reading,
         fmt::format("depth is read as {}, {}: {} (--depth-kind)", word_of(reading_.depth_kind),
                     facts_.program.by.empty() || facts_.program.rules->depth_kind == DepthKind::automatic
                         ? "the usual kind"
                         : "as " + facts_.program.rules->name + " writes it",
                     why));
  }

  std::string text_of(const std::vector<DepthScore>& scores) const {
    return fmt::format("{}, as {} {:.0f} %, as {} {:.0f} %", straight(scores[0]), word_of(scores[1].kind),
                       100 * scores[1].straight, word_of(scores[2].kind), 100 * scores[2].straight);
  }

  /// The share of the normals that agree with the depth if it is of that kind, in their best space; 0 without normals.
  double agreement_as(DepthKind kind) const {
    if (raw_.normal.size() != 3 * raw_.window.pixels()) return 0;
    const NormalStatistics n = normal_statistics(raw_.normal, raw_.depth, depth_map_of(reading_), step_);
    Reading reading = over(reading_, raw_.window);
    reading.depth_kind = kind;
    reading.normal_encoding = NormalEncoding::signed_float;
    reading.normal_unorm = n.unorm_unit_share > n.unit_share;
    const auto scores = score_normals({reading, raw_.normal, raw_.depth});
    return scores.empty() ? 0 : scores[0].agreement;
  }

  /// Whether all surfaces lie within 0 to 1, whatever stands for the sky.
  bool is_fraction() const { return surfaces_.positive && surfaces_.most <= 1 + kRounded; }

  std::string text_of_range() const {
    return fmt::format("all depth lies within 0 to 1 ({:.3g} to {:.3g})", surfaces_.least, surfaces_.most);
  }

  /// The straightness of flat surfaces if the depth falls from 1 at the eye to 0 at its far end.
  double straightness_from_1() const {
    std::vector<float> turned(raw_.depth.begin(), raw_.depth.end());
    for (float& d : turned) d = d > 0 && d < 1 ? 1 - d : 0;
    return straightness(score_depth(turned, view_, settings_.sky, seen_.grain), DepthKind::planar);
  }

  /// The options that read normalized depth, and the meaning of their number.
  static std::string normalized_line(bool reversed) {
    return fmt::format(
        "--depth-kind normalized{} --near 0 --far F, where F is the distance, in scene units, that {} stands for",
        reversed ? " --reversed-z" : "", reversed ? 0 : 1);
  }

  /// Depth within 0 to 1 is the part of a range more often than a distance, and no pixel shows how long that range is.
  /// It is refused where nothing supports distances, and noted where straight lines do: z / far has them too.
  void refuse_fractions(const std::vector<DepthScore>& scores) {
    if (!is_fraction()) return;
    const double straight = scores.empty() ? 0 : scores[0].straight, from_1 = straightness_from_1();
    if (from_1 >= kLeastStraight && from_1 > kClear * straight)
      fail(ErrorKind::input,
           "{}: {}, and flat surfaces are straight on {:.0f} % as 1 - depth, on {:.0f} % as depth: it is normalized, "
           "and 1 at the eye: give {}; if it is a distance all the same, --depth-kind planar",
           path_, text_of_range(), 100 * from_1, 100 * straight, normalized_line(true));
    const bool is_supported = straight >= kSurelyStraight;
    const bool is_inverse =
        straight >= kLeastStraight && scores[0].kind == DepthKind::inverse && straight >= kClear * scores[1].straight;
    if (facts_.program.rules->depth_kind != DepthKind::automatic && !is_supported && !is_inverse)
      return note_fractions();
    if (facts_.program.rules->depth_kind != DepthKind::automatic || is_inverse) return;
    refuse_plateau();
    if (!is_supported)
      fail(ErrorKind::input,
           "{}: {}, and no flat surfaces show that these are distances: if it is 0 at the eye, give {}; if it is 1 at "
           "the eye, {}; if it is a distance, --depth-kind planar; if it is 1/z, --depth-kind inverse; if it is a "
           "z-buffer, --depth-kind device with --near and --far",
           path_, text_of_range(), normalized_line(false), normalized_line(true));
    refuse_before_near_plane();
    note_fractions();
  }

  /// It is all that is said where the program is known to write distances: those of a macro scene are below 1.
  void note_fractions() {
    if (!is_distance(usual_)) return;
    note(NoteCode::depth_below_1,
         fmt::format("{} and is read as distances of less than 1 scene unit; if it is normalized, give {}",
                     text_of_range(), normalized_line(false)));
  }

  /// No surface is seen that is nearer than the near plane, so the depth of such is no distance.
  void refuse_before_near_plane() const {
    constexpr double kMostNearer = 0.01;  // of the surfaces: matrices and planes are rounded
    if (!reading_.camera.near) return;
    const double near = 0.99 * *reading_.camera.near / reading_.depth_scale;
    std::size_t count = 0, nearer = 0;
    for (std::size_t i = 0; i < raw_.depth.size(); i += step_)
      if (raw_.depth[i] > 0 && raw_.depth[i] < settings_.sky) count++, nearer += raw_.depth[i] < near;
    if (double(nearer) <= kMostNearer * double(count)) return;
    fail(ErrorKind::input,
         "{}: {}, and {:.0f} % of it is nearer than the camera's near plane at {:.3g}, so these are no distances: if "
         "they are normalized, give {}; if they are distances all the same, --depth-kind planar",
         path_, text_of_range(), 100 * double(nearer) / double(count), *reading_.camera.near, normalized_line(false));
  }

  /// A background of exactly 1 behind depths of 0 to 1 is the far end of a range.
  void refuse_plateau() const {
    if (values_.least < 0 || values_.most != 1 || double(values_.one) < kPlateau * double(values_.pixels)) return;
    fail(ErrorKind::input,
         "{}: the depth may be normalized or planar (all in 0 to 1, {:.1f} % of exactly 1): say --depth-kind "
         "normalized with --near and --far (or log, with "
         "--far and --set log-constant), or --depth-kind planar",
         path_, 100 * double(values_.one) / double(values_.pixels));
  }

  /// Notes near planes that differ. A projection matrix made for another depth range than the buffer's scales all
  /// distances, which no pixel shows.
  void compare_planes() {
    const auto near = reading_.depth_range.near;
    const auto by_file = reading_.camera.near;
    const auto by_matrix = reading_.camera.matrix_near;
    constexpr double kSame = 0.01;  // matrices are rounded
    if (reading_.depth_kind == DepthKind::device && settings_.depth_range.near && by_file &&
        std::abs(*near / *by_file - 1) >= kSame)
      note(NoteCode::near_plane, fmt::format("--near is {:.4g}, and the camera file's near plane is at {:.4g}: "
                                             "distances are {:.3g} times those by the file",
                                             *near, *by_file, *near / *by_file));
    if (reading_.depth_kind != DepthKind::device || reading_.depth_range.reversed ||
        reading_.depth_range.device != DeviceRange::zero_to_one)
      return;
    if (!near || !by_matrix || std::abs(*by_matrix / *near - 1) < kSame) return;
    note(NoteCode::near_plane,
         fmt::format("the near plane is {:.4g}, but the camera file's projection, read with z = depth, has it at "
                     "{:.4g}: so read, distances would be {:.3g} "
                     "times as large; trust the one that was measured (--near, --set device-range)",
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
      note(NoteCode::depth_below_1, fmt::format("{} and is read as {}; if it is normalized, give {}; "
                                                "--depth-kind {} says that these are distances",
                                                text_of_range(), word_of(reading_.depth_kind), normalized_line(false),
                                                word_of(reading_.depth_kind)));
  }

  /// Notes where the pixels speak against the kind of depth that is said. It is read so all the same.
  void doubt_kind() {
    doubt_range();
    const bool linear = reading_.depth_kind == DepthKind::normalized || reading_.depth_kind == DepthKind::log;
    const DepthKind said = reading_.depth_kind != DepthKind::device ? reading_.depth_kind
                           : reading_.camera.orthographic           ? DepthKind::planar
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

  /// The scores of the distances that the depth gives if it is read as is said.
  std::vector<DepthScore> scores_as_said() const {
    const auto planar = planar_depths(raw_.depth, depth_map_of(reading_), view_);
    return score_depth(planar, view_, settings_.sky, grain_of(planar, settings_.sky));
  }

  double straightness(const std::vector<DepthScore>& scores, DepthKind kind) const {
    if (reading_.camera.orthographic && kind == DepthKind::ray) kind = DepthKind::planar;
    const auto found = std::ranges::find(scores, kind, &DepthScore::kind);
    return found == scores.end() ? 0 : found->straight;
  }

  /// Notes a z-buffer that uses only half of its range, or that leaves it.
  void doubt_range() {
    if (reading_.depth_kind != DepthKind::device) return;
    const auto below = std::ranges::count_if(raw_.depth, [](float d) { return d > -1 && d < 0; });
    if (reading_.depth_range.device == DeviceRange::zero_to_one && below > 0)
      note(NoteCode::said_otherwise,
           fmt::format("{} pixels have a depth of -1 to 0 and count as sky: is it that of --set device-range=-1..1?",
                       below));
    if (reading_.depth_range.device == DeviceRange::minus_one_to_one && values_.least >= 0)
      note(NoteCode::said_otherwise,
           "no depth is below 0, so the nearest surface is beyond twice the near plane, or the depth is not that of "
           "--set device-range=-1..1");
  }

  /// Inverse depth and that of a z-buffer are both affine in 1/z. A near plane that somebody knows tells them apart.
  /// Sky is at the far plane.
  void settle_device(const std::string& why) {
    const bool reversed = reading_.depth_range.reversed || (values_.zero && !values_.one);
    if (!settings_.depth_range.near || !reading_.depth_range.far || !(reversed || values_.one))
      fail(ErrorKind::input,
           "{}: the depth may be device or inverse (all in 0 to 1, {}): say --depth-kind device with --near and --far "
           "(inf where there is none) and, "
           "where near is 1, --reversed-z; or --depth-kind inverse",
           path_, why);
    reading_.depth_range.reversed = reversed;
    reading_.depth_kind = DepthKind::device;
    guess("depth kind", reversed ? "device with --reversed-z" : "device", "all in 0 to 1, --near is given, and " + why,
          "--depth-kind", true);
  }

  void settle_position() {
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
          ErrorKind::input,
          "{}: its positions lie {} from the pixels that hold them: check --set position-space and --camera", path_,
          *best->error < 1e6 ? fmt::format("{:.1f} pixels (median)", *best->error) : "on the other side of the camera");
    reading_.position_space = best->space;
    reading_.depth_range.negative = best->forward;
    if (settings_.position_space == PositionSpace::automatic)
      guess("position space", best->space == PositionSpace::world ? "world" : "view",
            fmt::format("positions lie {:.3f} pixels (median) from the pixels that hold them", *best->error),
            "--set position-space", false);
  }

  const DepthFacts& facts_;
  DepthKind usual_;                   // of the program, for what is open
  const std::size_t step_;            // from one pixel that is looked at to the next
  Side below_0_, above_0_, above_1_;  // finite, and nearer than the sky
  ValueStatistics values_;            // of all pixels
  ValueStatistics surfaces_;          // above 0 and before the sky: of distances, all that are surfaces
};

}  // namespace

void settle_depth(const PlanesToSettle& planes, const DepthFacts& facts) { DepthSettlement(planes, facts).run(); }

}  // namespace alcove
