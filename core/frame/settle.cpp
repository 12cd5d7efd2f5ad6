// Scores the ways in which a frame's values may be read, and chooses one.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/error.h"
#include "core/frame/evidence.h"

namespace alcove {
namespace {

/// The usual reading stays where its score is at least this part of the best one.
constexpr double kAsGood = 0.8;
/// Another reading is taken only where it is this many times as good as the second best.
constexpr double kClear = 2;
/// Where a smaller part of the smooth places is straight, the frame has no flat surfaces that could tell.
constexpr double kLeastStraight = 0.02;
/// From this part of the smooth places on, flat surfaces speak for a kind by themselves.
constexpr double kSurelyStraight = 0.1;
/// Where the normals agree with depth less than this part of the best agreement, another reading of them is chosen, or
/// noted.
constexpr double kNoBetter = 0.95;
/// So many of the normals must agree with depth. Some reading reaches half by chance, as rooms have three directions.
constexpr double kLeastAgreement = 0.6;
/// Degrees. If the best quarter of the normals is farther off than this, normals and depth are of different cameras or
/// planes.
constexpr double kLargestAngle = 2;
/// If this part of the normals has unit length, they are vectors.
constexpr double kUnit = 0.9;
/// If this part of the pixels is exactly 1, that is a background.
constexpr double kPlateau = 0.001;
/// Pixels. If the median is farther off than this, positions are not what they are taken for.
constexpr double kLargestError = 2;
/// One of so many pixels is enough for statistics. It is a prime, so that no column is favoured.
constexpr std::size_t kSparse = 31;

class Settlement {
 public:
  Settlement(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
             std::span<const float> normal)
      : source_(source),
        settings_(settings),
        depth_(depth),
        normal_(normal),
        view_(view_of(source.camera, source.data, source.display)),
        values_(statistics_of(depth, kSparse)) {}

  void run() {
    const auto is_near = [&](std::size_t i) {
      return std::isfinite(depth_[i]) && depth_[i] != 0 && std::abs(depth_[i]) < settings_.sky;
    };
    source_.has_evidence = false;
    for (std::size_t i = 0; i < depth_.size() && !source_.has_evidence; i += kSparse) source_.has_evidence = is_near(i);
    if (source_.depth_kind == DepthKind::position)
      settle_position();
    else
      settle_depth();
    if (source_[RawPlane::normal].empty()) return;
    settle_encoding();
    settle_space();
  }

 private:
  const std::string& depth_path() const { return source_.depth_path(); }
  const std::string& normal_path() const { return source_.files[source_[RawPlane::normal][0].file].path(); }

  void guess(const std::string& what, const std::string& chosen, const std::string& why, const std::string& option,
             bool unusual) {
    if (settings_.strict)
      fail(ErrorKind::input, "{}: --strict, and nothing says the {}; it would be {} ({}): give {}", depth_path(), what,
           chosen, why, option);
    source_.guesses.push_back({what, chosen, why, option});
    if (unusual)
      source_.notes.push_back(fmt::format("{} taken as {}: {} ({} says otherwise)", what, chosen, why, option));
  }

  void settle_depth() {
    if (source_.depth_kind_open)
      settle_kind();
    else
      doubt_kind();
    compare_planes();
    const bool signed_kind = source_.depth_kind == DepthKind::planar || source_.depth_kind == DepthKind::ray ||
                             source_.depth_kind == DepthKind::inverse;
    if (!signed_kind || values_.positive || !values_.negative || values_.least == values_.most) return;
    source_.depth_range.negative = true;
    source_.notes.push_back("all depth values are negative: their distance from 0 is the depth");
  }

  std::string straight(const DepthScore& score) const {
    return fmt::format("{} is straight on {:.0f} % only as {}", source_.camera.orthographic ? "z" : "1/z",
                       100 * score.straight, name_of(score.kind));
  }

  /// Reads the depth as the program that wrote the frame, or most programs, write it. It is no guess where the user
  /// named the program.
  void take_usual(const std::string& why) {
    source_.depth_kind = source_.usual_depth_kind;
    const std::string by =
        source_.rules_by.empty() ? "" : fmt::format("{} writes it ({}); ", source_.rules->name, source_.rules_by);
    guess("depth kind", name_of(source_.depth_kind), by + why, "--depth-kind", false);
  }

  void settle_kind() {
    const DepthKind usual = source_.usual_depth_kind;
    const bool between_planes = usual == DepthKind::device || usual == DepthKind::normalized || usual == DepthKind::log;
    if (between_planes && values_.least >= 0 && values_.most <= 1) return take_usual("all in 0 to 1");
    if (between_planes) source_.usual_depth_kind = source_.depth_kind = DepthKind::planar;
    const auto scores = score_depth(depth_, view_, settings_.sky, depth_rounding(source_));
    if (scores.empty() || scores[0].straight < kLeastStraight) source_.has_evidence = false;
    if (scores.empty()) return take_usual("too little of the frame is smooth to tell");
    const auto& expected = *std::ranges::find(scores, source_.usual_depth_kind, &DepthScore::kind);
    const std::string why = fmt::format("{}, {}, {}", straight(scores[0]), straight(scores[1]), straight(scores[2]));
    const DepthScore &best = scores[0], &second = scores[1];
    if (source_.rules->depth_kind == DepthKind::automatic && best.kind != DepthKind::inverse) refuse_plateau();
    if (best.straight < kLeastStraight) return take_usual("the frame has no flat surfaces that tell: " + why);
    if (expected.straight >= kAsGood * best.straight) return take_usual(why);
    if (best.straight < kClear * second.straight)
      fail(ErrorKind::input, "{}: the depth may be {} or {} ({}): say which with --depth-kind {} or --depth-kind {}",
           depth_path(), name_of(best.kind), name_of(second.kind), why, name_of(best.kind), name_of(second.kind));
    source_.depth_kind = best.kind;
    if (best.kind == DepthKind::inverse && values_.least >= 0 && values_.most <= 1) return settle_device(why);
    guess("depth kind", name_of(best.kind), why, "--depth-kind", true);
  }

  /// A background of exactly 1 behind depths of 0 to 1 is the far end of a range, and no pixel shows how far away that
  /// is.
  void refuse_plateau() const {
    if (values_.least < 0 || values_.most != 1 || double(values_.one) < kPlateau * double(values_.pixels)) return;
    fail(ErrorKind::input,
         "{}: the depth may be normalized or planar (all in 0 to 1, {:.1f} % of exactly 1): say --depth-kind "
         "normalized with --near and --far (or log, with "
         "--far and --log-constant), or --depth-kind planar",
         depth_path(), 100 * double(values_.one) / double(values_.pixels));
  }

  /// Notes near planes that differ. A projection matrix made for another depth range than the buffer's scales all
  /// distances, which no pixel shows.
  void compare_planes() {
    const auto near = source_.depth_range.near;
    const auto by_file = source_.camera.near;
    const auto by_matrix = source_.camera.matrix_near;
    constexpr double kSame = 0.01;  // matrices are rounded
    if (source_.depth_kind == DepthKind::device && settings_.depth_range.near && by_file &&
        std::abs(*near / *by_file - 1) >= kSame)
      source_.notes.push_back(
          fmt::format("--near is {:.4g}, and the camera file's near plane is at {:.4g}: distances are {:.3g} times "
                      "what they are by that",
                      *near, *by_file, *near / *by_file));
    if (source_.depth_kind != DepthKind::device || source_.depth_range.reversed ||
        source_.depth_range.device != DeviceRange::zero_to_one)
      return;
    if (!near || !by_matrix || std::abs(*by_matrix / *near - 1) < kSame) return;
    source_.notes.push_back(
        fmt::format("the near plane is {:.4g}, but the camera file's projection, read with z = depth, has it at "
                    "{:.4g}: so read, distances would be {:.3g} "
                    "times as large; trust the one that was measured (--near, --device-range)",
                    *near, *by_matrix, *by_matrix / *near));
  }

  /// Notes where the pixels speak against the kind of depth that is said. It is read so all the same.
  void doubt_kind() {
    doubt_range();
    const bool linear = source_.depth_kind == DepthKind::normalized || source_.depth_kind == DepthKind::log;
    const DepthKind said = source_.depth_kind != DepthKind::device ? source_.depth_kind
                           : source_.camera.orthographic           ? DepthKind::planar
                                                                   : DepthKind::inverse;
    const auto scores = score_depth(depth_, view_, settings_.sky, depth_rounding(source_));
    if (scores.empty() || scores[0].straight < (linear ? kSurelyStraight : kLeastStraight)) return;
    if (kClear * straightness(linear ? scores_as_said() : scores, linear ? DepthKind::planar : said) >
        scores[0].straight)
      return;
    source_.notes.push_back(
        fmt::format("depth is read as {}, as --depth-kind, --source or the camera file says, but {}: is it {}?",
                    name_of(source_.depth_kind), straight(scores[0]),
                    scores[0].kind == DepthKind::inverse ? "inverse or device" : name_of(scores[0].kind)));
  }

  /// The scores of the distances that the depth gives if it is read as is said.
  std::vector<DepthScore> scores_as_said() const {
    return score_depth(planar_depths(depth_, depth_map_of(source_), view_), view_, settings_.sky,
                       2 * depth_rounding(source_));
  }

  double straightness(const std::vector<DepthScore>& scores, DepthKind kind) const {
    if (source_.camera.orthographic && kind == DepthKind::ray) kind = DepthKind::planar;
    const auto found = std::ranges::find(scores, kind, &DepthScore::kind);
    return found == scores.end() ? 0 : found->straight;
  }

  /// Notes a z-buffer that uses only half of its range, or that leaves it.
  void doubt_range() {
    if (source_.depth_kind != DepthKind::device) return;
    const auto below = std::ranges::count_if(depth_, [](float d) { return d > -1 && d < 0; });
    if (source_.depth_range.device == DeviceRange::zero_to_one && below > 0)
      source_.notes.push_back(fmt::format(
          "{} pixels have a depth of -1 to 0 and count as sky: is it that of --device-range=-1..1?", below));
    if (source_.depth_range.device == DeviceRange::minus_one_to_one && values_.least >= 0)
      source_.notes.push_back(
          "no depth is below 0, so the nearest surface is beyond twice the near plane, or the depth is not that of "
          "--device-range=-1..1");
  }

  /// Inverse depth and that of a z-buffer are both affine in 1/z. A near plane that somebody knows tells them apart.
  /// Sky is at the far plane.
  void settle_device(const std::string& why) {
    const bool reversed = source_.depth_range.reversed || (values_.zero && !values_.one);
    if (!settings_.depth_range.near || !source_.depth_range.far || !(reversed || values_.one))
      fail(ErrorKind::input,
           "{}: the depth may be device or inverse (all in 0 to 1, {}): say --depth-kind device with --near and --far "
           "(inf where there is none) and, "
           "where near is 1, --reversed-z; or --depth-kind inverse",
           depth_path(), why);
    source_.depth_range.reversed = reversed;
    source_.depth_kind = DepthKind::device;
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
            (space == PositionSpace::view || (source_.camera.view_from_world && !forward)))
          candidates.push_back({space, forward, reprojection_error(depth_, space, forward, source_.camera, view_)});
    // no world matrix, which the map complains about; or nothing but sky
    if (candidates.empty() || !candidates[0].error) return;
    const auto best = std::ranges::min_element(candidates, {}, &Candidate::error);
    if (!(*best->error <= kLargestError))
      fail(
          ErrorKind::input,
          "{}: its positions lie {} from the pixels that hold them: check --position-space and --camera", depth_path(),
          *best->error < 1e6 ? fmt::format("{:.1f} pixels (median)", *best->error) : "on the other side of the camera");
    source_.position_space = best->space;
    source_.depth_range.negative = best->forward;
    if (settings_.position_space == PositionSpace::automatic)
      guess("position space", best->space == PositionSpace::world ? "world" : "view",
            fmt::format("positions lie {:.3f} pixels (median) from the pixels that hold them", *best->error),
            "--position-space", false);
  }

  static const char* name_of(NormalEncoding encoding, bool unorm) {
    if (encoding == NormalEncoding::octahedral) return "octahedral";
    if (encoding == NormalEncoding::spheremap) return "spheremap";
    return unorm ? "unorm" : "signed";
  }

  std::vector<NormalScore> scores_of(NormalEncoding encoding, bool unorm) const {
    return score_normals(normal_, encoding, unorm, depth_, depth_map_of(source_), source_.camera, view_);
  }

  static bool agrees(const NormalScore& score) {
    return score.agreement >= kLeastAgreement && score.angle <= kLargestAngle;
  }

  void settle_encoding() {
    const bool is_open = source_.normal_encoding_open;
    const NormalStatistics n = normal_statistics(normal_, depth_, depth_map_of(source_), kSparse);
    if (!is_open) doubt_encoding(n);
    const bool in_unit_range = n.count && n.least >= 0 && n.most <= 1;
    const NormalEncoding said = source_.normal_encoding;
    std::string why = source_[RawPlane::normal].size() == 2
                          ? fmt::format("all in {:.2g} to {:.2g}", n.least, n.most)
                          : fmt::format("of unit length on {:.0f} %", 100 * n.unit_share);
    if (said == NormalEncoding::octahedral || said == NormalEncoding::spheremap ||
        source_[RawPlane::normal].size() == 2) {
      source_.normal_unorm =
          said == NormalEncoding::unorm || (in_unit_range && (is_open || said != NormalEncoding::signed_float));
    } else {
      const bool is_unorm =
          is_open && in_unit_range && n.unorm_unit_share > 0.5 && n.unit_share < 0.5 * n.unorm_unit_share;
      if (is_unorm)
        why = fmt::format("all in 0 to 1, and 2 n - 1 is of unit length on {:.0f} %", 100 * n.unorm_unit_share);
      source_.normal_unorm = is_unorm || said == NormalEncoding::unorm;
    }
    const bool tells = source_[RawPlane::normal].size() == 3 && std::max(n.unit_share, n.unorm_unit_share) > kUnit;
    const bool differs = !tells && compare_encodings(in_unit_range, why);
    if (is_open)
      guess("normal encoding", name_of(source_.normal_encoding, source_.normal_unorm), why, "--normal-encoding",
            differs || source_.normal_unorm);
  }

  /// If the normals do not agree with depth, and do so much better in another encoding, that one is chosen where nobody
  /// says one, and else noted. Returns whether it was chosen.
  bool compare_encodings(bool in_unit_range, std::string& why) {
    const auto scores = scores_of(source_.normal_encoding, source_.normal_unorm);
    if (scores.empty() || agrees(scores[0])) return false;
    std::optional<std::pair<NormalEncoding, double>> best;
    for (const auto encoding : {NormalEncoding::signed_float, NormalEncoding::octahedral, NormalEncoding::spheremap}) {
      const auto others = scores_of(encoding, in_unit_range);
      if (others.empty() || !agrees(others[0]) || (best && others[0].angle >= best->second)) continue;
      if (kClear * others[0].angle < scores[0].angle || scores[0].agreement < kAsGood * others[0].agreement)
        best = {encoding, others[0].angle};
    }
    if (!best) return false;
    why = fmt::format(
        "as {} the best quarter of the normals agrees with depth within {:.1f} degrees, as {} within {:.1f}, and "
        "{:.0f} % agree at all",
        name_of(best->first, in_unit_range), best->second, name_of(source_.normal_encoding, source_.normal_unorm),
        scores[0].angle, 100 * scores[0].agreement);
    if (!source_.normal_encoding_open) {
      source_.notes.push_back(why + ": is --normal-encoding right?");
      return false;
    }
    source_.normal_encoding = best->first;
    source_.normal_unorm = in_unit_range;
    return true;
  }

  /// Notes where the lengths of the normals speak against the encoding that is said.
  void doubt_encoding(const NormalStatistics& n) {
    constexpr double kFew = 0.5;  // of the normals
    if (source_[RawPlane::normal].size() != 3) return;
    const bool is_signed = n.unit_share > kUnit && n.unorm_unit_share < kFew;
    const bool is_unorm = n.unorm_unit_share > kUnit && n.unit_share < kFew;
    if (is_signed && source_.normal_encoding != NormalEncoding::signed_float)
      source_.notes.push_back(
          fmt::format("the normals are signed vectors by their lengths (of 1 on {:.0f} %), and --normal-encoding or "
                      "the camera file says otherwise",
                      100 * n.unit_share));
    if (is_unorm && source_.normal_encoding == NormalEncoding::signed_float)
      source_.notes.push_back(
          fmt::format("2 n - 1 of the normals is of unit length on {:.0f} %: are they unorm (--normal-encoding)?",
                      100 * n.unorm_unit_share));
  }

  void settle_space() {
    const bool has_world = source_.camera.view_from_world.has_value();
    const bool usually_view = source_.usual_normal_space == NormalSpace::view;
    const auto all_scores = scores_of(source_.normal_encoding, source_.normal_unorm);
    if (!source_.normal_space_open) return doubt_normals(all_scores);
    const std::string given = to_string(settings_.flip_normal);
    auto scores = all_scores;
    if (given != "none") std::erase_if(scores, [&](const auto& s) { return to_string(s.flips) != given; });
    const auto usual = std::ranges::find_if(
        scores, [&](const auto& s) { return s.space == source_.usual_normal_space && to_string(s.flips) == given; });
    const bool tells = !scores.empty() && scores[0].agreement >= kLeastAgreement;
    if (!tells) source_.has_evidence = false;
    if ((has_world || usually_view) && (!tells || usual->agreement >= kNoBetter * scores[0].agreement)) {
      source_.normal_space = source_.usual_normal_space;
      guess("normal space", name_of(source_.normal_space), tells ? text_of(*usual) : "the frame does not tell",
            "--normal-space", false);
      return doubt_normals(all_scores);
    }
    if (!tells)
      fail(ErrorKind::input,
           "{}: its normals are in world space, and the camera has no world_to_camera: give a --camera file with it, "
           "or --normal-space view",
           normal_path());
    const auto other = std::ranges::find_if(scores, [&](const auto& s) { return s.space != scores[0].space; });
    if (other != scores.end() && other->agreement >= kAsGood * scores[0].agreement)
      fail(ErrorKind::input,
           "{}: its normals may be in {} or in {} space ({}; {}): say which with --normal-space, and --flip-normal",
           normal_path(), name_of(scores[0].space), name_of(other->space), text_of(scores[0]), text_of(*other));
    source_.normal_space = scores[0].space;
    source_.flip_normal = scores[0].flips;
    guess("normal space", name_of(source_.normal_space), text_of(scores[0]), "--normal-space with --flip-normal",
          source_.normal_space != source_.usual_normal_space || has_world || to_string(scores[0].flips) != "none");
    doubt_normals(all_scores);
  }

  static const char* name_of(NormalSpace space) { return space == NormalSpace::world ? "world" : "view"; }
  static const char* name_of(DepthKind kind) { return alcove::name_of(kind); }
  static std::string text_of(const NormalScore& s) {
    return fmt::format("{} with flips {}: {:.0f} % agree with depth, {:.0f} % face the camera", name_of(s.space),
                       to_string(s.flips), 100 * s.agreement, 100 * s.facing);
  }

  /// Notes where depth speaks against the normals as they are read.
  void doubt_normals(const std::vector<NormalScore>& scores) {
    const auto chosen = std::ranges::find_if(scores, [&](const auto& s) {
      return s.space == source_.normal_space && to_string(s.flips) == to_string(source_.flip_normal);
    });
    if (chosen == scores.end()) return;
    const bool another = scores[0].agreement >= kLeastAgreement && chosen->agreement < kNoBetter * scores[0].agreement;
    if (another)
      source_.notes.push_back(fmt::format("normals are read as {}; better fits {} (--normal-space, --flip-normal)",
                                          text_of(*chosen), text_of(scores[0])));
    else if (chosen->agreement < kLeastAgreement)
      source_.notes.push_back(fmt::format("only {:.0f} % of the normals agree with depth in any space: {}",
                                          100 * scores[0].agreement, kCheck));
    else if (!agrees(*chosen) && depth_rounding(source_) == kFloatRounding)
      source_.notes.push_back(
          fmt::format("even the best quarter of the normals is up to {:.1f} degrees off those of depth: {}",
                      chosen->angle, kCheck));
  }

  static constexpr const char* kCheck =
      "check --normal-encoding, --depth-kind with --near, --far and --reversed-z, and --camera or --fov";

  FrameSource& source_;
  const InputSettings& settings_;
  std::span<const float> depth_, normal_;
  View view_;
  ValueStatistics values_;
};

/// Refuses depth that was saved as a grey picture: it has no more than 256 distances.
void refuse_8_bits(const FrameSource& source, std::span<const float> depth) {
  if (source[RawPlane::depth].size() != 1) return;
  constexpr std::size_t kLeastLevels = 16;  // fewer may be a few walls that happen to lie there
  std::set<double> levels;
  for (std::size_t i = 0; i < depth.size(); i += kSparse) {
    const double level = 255.0 * depth[i];
    if (!(level >= 0 && level <= 255) || std::abs(level - std::round(level)) > 1e-4) return;
    levels.insert(std::round(level));
  }
  if (levels.size() >= kLeastLevels)
    fail(ErrorKind::input,
         "{}: {} holds only values of 8 bits, too few distances for AO: save depth as EXR, or as DDS (--depth)",
         source.depth_path(), source[RawPlane::depth][0].channel);
}

/// Half floats step by a 1024th of the power of two below the value.
void note_half(FrameSource& source, std::span<const float> depth) {
  if (depth_rounding(source) != kHalfRounding) return;
  std::vector<float> values;
  for (std::size_t i = 0; i < source.data.pixels(); i += kSparse)
    if (std::isfinite(depth[i]) && depth[i] != 0 && std::abs(depth[i]) < 65504) values.push_back(std::abs(depth[i]));
  if (values.empty()) return;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::ranges::nth_element(values, middle);
  const double step = std::exp2(std::floor(std::log2(*middle)) - 10);
  source.suspicious.push_back(
      fmt::format("{} is stored as half float: at its median {:.4g} it changes in steps of {:.2g}, which AO shows as "
                  "bands; write it as float",
                  source[RawPlane::depth][0].channel, *middle, step));
}

}  // namespace

void settle(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
            std::span<const float> normal) {
  refuse_8_bits(source, depth);
  Settlement(source, settings, depth, normal).run();
  note_half(source, depth);
  const bool is_fraction = source.depth_kind == DepthKind::device || source.depth_kind == DepthKind::normalized ||
                           source.depth_kind == DepthKind::log;
  source.depth_step = is_fraction ? step_of(depth) : 0;
  source.settled = true;
}

double depth_rounding(const Reading& reading) { return reading.depth_is_half ? kHalfRounding : kFloatRounding; }

void settle_by_rows(FrameSource& source, const InputSettings& settings) {
  const Window data = source.data;
  const Window whole = source.file_data;
  if (std::size_t(whole.width) > kEvidencePixels)
    fail(ErrorKind::device, "{}: rows of {} pixels are more than Alcove takes on any --device", source.depth_path(),
         whole.width);
  const int rows =
      int(std::clamp<std::size_t>(kEvidencePixels / std::size_t(whole.width), 1, std::size_t(whole.height)));
  source.data = {whole.x, whole.y + (whole.height - rows) / 2, whole.width, rows};
  std::vector<float> depth(source[RawPlane::depth].size() * source.data.pixels()),
      normal(source[RawPlane::normal].size() * source.data.pixels());
  read_planes(source, {{&source[RawPlane::depth], depth.data()}, {&source[RawPlane::normal], normal.data()}});
  settle(source, settings, depth, normal);
  source.data = data;
}

bool settle_like(FrameSource& source, const FrameSource& settled) {
  for (const RawPlane plane : {RawPlane::depth, RawPlane::normal})
    if (source[plane].size() != settled[plane].size()) return false;
  read_like(source, settled);
  return source.settled = true;
}

}  // namespace alcove
