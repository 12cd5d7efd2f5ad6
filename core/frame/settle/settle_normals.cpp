// Scores the ways in which a frame's normals may be read, chooses one, and refuses what depth and camera refute: other
// cameras and the usual alterations of pictures are tried.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/camera/camera.h"
#include "core/frame/evidence.h"
#include "core/frame/settle/settle.h"

namespace alcove {
namespace {

// Alterations of normals that left them with the lengths of no vectors.

/// Undoing the alteration must make vectors of this share of the normals.
constexpr double kProven = 0.9;

// The curve of sRGB, which goes on below 0 with the other sign.
double linear_of(double v) {
  const double a = std::abs(v);
  return std::copysign(a <= 0.04045 ? a / 12.92 : std::pow((a + 0.055) / 1.055, 2.4), v);
}
double curved_of(double v) {
  const double a = std::abs(v);
  return std::copysign(a <= 0.0031308 ? a * 12.92 : 1.055 * std::pow(a, 1 / 2.4) - 0.055, v);
}

/// Neighbours belong to one surface if their normals differ by less, as they stand in the file.
constexpr double kSameNormal = 0.1;

/// Every so many pixels, of those that lie within a surface: a pixel filter shortens normals at edges only.
std::vector<std::size_t> within_surfaces(std::span<const float> normal, std::size_t width) {
  const std::size_t pixels = normal.size() / 3;
  const auto is_near = [&](std::size_t i, std::size_t k) {
    double squared = 0;
    for (const std::size_t plane : {std::size_t(0), pixels, 2 * pixels})
      squared += std::pow(double(normal[plane + i]) - normal[plane + k], 2);
    return squared < kSameNormal * kSameNormal;
  };
  std::vector<std::size_t> some;
  for (std::size_t i = 0; i < pixels; i += kSparse)
    if (i >= width && i + width < pixels && is_near(i, i - 1) && is_near(i, i + 1) && is_near(i, i - width) &&
        is_near(i, i + width))
      some.push_back(i);
  return some;
}

/// These pixels of planes.
std::vector<float> values_at(std::span<const float> planes, std::size_t pixels, const std::vector<std::size_t>& at) {
  std::vector<float> values;
  for (std::size_t plane = 0; plane < planes.size(); plane += pixels)
    for (const std::size_t i : at) values.push_back(planes[plane + i]);
  return values;
}

/// Names the alteration of signed normals or of 0.5 + 0.5 n if undoing it gives nearly all of them unit length: a
/// picture's curve, or an exposure. It ends a sentence that begins with "they look like". Normals have three planes.
std::optional<std::string> alteration_of(const RawPart& raw, const DepthMap& map) {
  const std::size_t pixels = raw.normal.size() / 3;
  const auto at = within_surfaces(raw.normal, std::size_t(raw.window.width));
  if (at.empty()) return std::nullopt;
  const std::vector<float> some = values_at(raw.normal, pixels, at), depth = values_at(raw.depth, pixels, at);
  const auto with = [&](const auto& undo) {
    std::vector<float> undone(some.size());
    for (std::size_t i = 0; i < some.size(); i++) undone[i] = float(undo(some[i]));
    return normal_statistics(undone, depth, map);
  };
  const auto curve = [&](const NormalStatistics& s, const char* way) -> std::optional<std::string> {
    if (s.unorm_unit_share > kProven) return fmt::format("0.5 + 0.5 n that was converted {}", way);
    if (s.unit_share > kProven) return fmt::format("vectors that were converted {}", way);
    return std::nullopt;
  };
  const NormalStatistics unchanged = with([](double v) { return v; });
  if (std::max(unchanged.unit_share, unchanged.unorm_unit_share) > kProven) return std::nullopt;
  if (auto found = curve(with(curved_of), "from sRGB to linear, as colours are")) return found;
  if (auto found = curve(with(linear_of), "from linear to sRGB, as colours are")) return found;
  for (const double exposure : {0.25, 0.5, 2.0, 4.0})
    if (with([&](double v) { return v / exposure; }).unorm_unit_share > kProven)
      return fmt::format("0.5 + 0.5 n times {}", exposure);
  return std::nullopt;
}

// The mistakes that cameras come with, each undone.

/// A camera that was tried, its score, and the fault of the given camera if this one is right.
struct OtherCamera {
  std::string what;  // a sentence that says what to do, without a full stop
  NormalScore score;
};

/// A principal point that far from the centre is no rounding. Part of the picture's width or height.
constexpr double kOffCentre = 0.02;

struct Hypothesis {
  std::string what;
  NormalPlanes planes;
};

/// The hypothesis that agrees best, where the frame can tell.
std::optional<OtherCamera> best_of(const std::vector<Hypothesis>& hypotheses, const NormalScore& as) {
  std::optional<OtherCamera> best;
  for (const auto& [what, planes] : hypotheses)
    if (const auto score = score_normals_as(as.space, as.flips, planes))
      if (!best || score->close > best->score.close) best = OtherCamera{what, *score};
  return best;
}

/// The same camera with the angles of its .chan file in another order.
std::vector<Hypothesis> other_rotations(const NormalPlanes& planes) {
  std::vector<Hypothesis> turned;
  for (const char* rotation : kChanRotations) {
    if (!planes.camera.chan_angles) break;
    turned.push_back({fmt::format("its angles fit in another order: give --chan-rotation {}", rotation), planes});
    turned.back().planes.camera.view_from_world = view_by_angles(*planes.camera.chan_angles, rotation);
  }
  return turned;
}

/// The same camera with its matrix replaced.
std::vector<Hypothesis> turned_worlds(const NormalPlanes& planes) {
  if (!planes.camera.view_from_world) return {};
  constexpr Matrix3 kOpenCv{{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
  constexpr Matrix3 kYUp{{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
  const Matrix3 given = *planes.camera.view_from_world, inverse = transposed(given);
  std::vector<Hypothesis> turned;
  const auto add = [&](const std::string& what, const Matrix3& matrix) {
    turned.push_back({what, planes});
    turned.back().planes.camera.view_from_world = matrix;
  };
  add("its world_to_camera looks like camera_to_world: give the inverse", inverse);
  add("its world_to_camera looks like that of a camera with y down that looks along +z, as OpenCV's: negate its second "
      "and its third row",
      product(kOpenCv, given));
  add("its world_to_camera looks like camera_to_world of a camera with y down that looks along +z, as OpenCV's: give "
      "the inverse, with its second and its third row negated",
      product(kOpenCv, inverse));
  for (const Matrix3& up : {kYUp, transposed(kYUp)})
    add("its world_to_camera looks like that of a world with another axis up than the normals have (y, or z): give it "
        "for the world of the normals",
        product(given, up));
  std::ranges::move(other_rotations(planes), std::back_inserter(turned));
  return turned;
}

/// The same camera on a picture whose rows or columns run the other way.
std::vector<Hypothesis> turned_pictures(const NormalPlanes& planes) {
  NormalPlanes upside_down = planes, mirrored = planes;
  upside_down.view.center.y = float(planes.view.size.y) - planes.view.center.y;
  upside_down.view.tangent_per_pixel.y = -planes.view.tangent_per_pixel.y;
  mirrored.view.center.x = float(planes.view.size.x) - planes.view.center.x;
  mirrored.view.tangent_per_pixel.x = -planes.view.tangent_per_pixel.x;
  return {{"its rows seem to run from the bottom to the top: turn the picture upside down", upside_down},
          {"its columns seem to run from the right to the left: mirror the picture", mirrored}};
}

/// The rotation by which a turn, in radians about an axis, is undone.
Matrix3 turned_back(const Vector3& turn) {
  const double angle = length(turn);
  if (angle == 0) return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const Vector3 axis = scaled(turn, -1 / angle);
  const double s = std::sin(angle), c = std::cos(angle);
  Matrix3 rotation;
  for (std::size_t column = 0; column < 3; column++) {
    Vector3 unit{};
    unit[column] = 1;
    const Vector3 across = cross(axis, unit);
    for (std::size_t row = 0; row < 3; row++)
      rotation[row][column] = c * unit[row] + s * across[row] + (1 - c) * axis[row] * axis[column];
  }
  return rotation;
}

bool is_off(double centre, int size) { return std::abs(2 * centre - size) > 2 * kOffCentre * size; }

/// Whether the principal point is so far from the picture's centre that it matters on which side.
bool is_off_centre(const Camera& camera) { return is_off(camera.cx, camera.width) || is_off(camera.cy, camera.height); }

/// Gives the best of the usual mistakes by which a camera turns the world or the picture: the inverse of its matrix,
/// axes of another convention, another axis up, angles in another order, a picture that is upside down. None where too
/// little of the frame is smooth. `as` is the reading of the normals that is tried.
std::optional<OtherCamera> best_turned_camera(const NormalPlanes& planes, const NormalScore& as) {
  std::vector<Hypothesis> hypotheses = turned_pictures(planes);
  if (as.space == NormalSpace::world) std::ranges::move(turned_worlds(planes), std::back_inserter(hypotheses));
  return best_of(hypotheses, as);
}

/// Gives the camera that is turned by a small angle within a world, whose normals then look like those of view space.
/// `as` is how they agree in view space. None where too little of the frame is smooth.
std::optional<OtherCamera> slightly_turned_camera(NormalPlanes planes, const NormalScore& as) {
  NormalScore turned = as;
  planes.camera.view_from_world = view_from_normal(planes.camera, NormalSpace::view, {});
  // The turn is that of small ones: a second step leaves less than a hundredth of it.
  for (int step = 0; step < 2; step++) {
    planes.camera.view_from_world = product(turned_back(turned.turn), *planes.camera.view_from_world);
    const auto score = score_normals_as(NormalSpace::world, as.flips, planes);
    if (!score) return std::nullopt;
    turned = *score;
  }
  return OtherCamera{fmt::format("a camera that is turned by about {:.0f} degrees", as.turn_degrees()), turned};
}

/// Gives the best of the orders in which the angles of a .chan file may turn the camera; none for other cameras, and
/// for normals in view space.
std::optional<OtherCamera> best_other_rotation(const NormalPlanes& planes, const NormalScore& as) {
  if (as.space != NormalSpace::world) return std::nullopt;
  return best_of(other_rotations(planes), as);
}

/// Gives the best of the cameras with the principal point on the other side of the picture's centre, by x, by y or by
/// both, or in the centre.
std::optional<OtherCamera> best_other_point(const NormalPlanes& planes, const NormalScore& as) {
  const Camera& camera = planes.camera;
  const double x = camera.width - camera.cx, y = camera.height - camera.cy;
  const float by_x = float(x - camera.cx), by_y = float(y - camera.cy);
  const bool x_is_off = is_off(camera.cx, camera.width), y_is_off = is_off(camera.cy, camera.height);
  std::vector<Hypothesis> hypotheses;
  const auto add = [&](const std::string& what, float dx, float dy) {
    auto& center = hypotheses.emplace_back(Hypothesis{what, planes}).planes.view.center;
    center = {center.x + dx, center.y + dy};
  };
  const std::string mirrored = "its principal point looks mirrored: try ";
  if (x_is_off) add(fmt::format("{}\"cx\": {:.6g}", mirrored, x), by_x, 0);
  if (y_is_off) add(fmt::format("{}\"cy\": {:.6g}", mirrored, y), 0, by_y);
  if (x_is_off && y_is_off) add(fmt::format("{}\"cx\": {:.6g}, \"cy\": {:.6g}", mirrored, x, y), by_x, by_y);
  add(fmt::format("its principal point looks wrong: try \"cx\": {}, \"cy\": {}, the centre", 0.5 * camera.width,
                  0.5 * camera.height),
      0.5f * by_x, 0.5f * by_y);
  return best_of(hypotheses, as);
}

/// Gives the best of a few wider and narrower fields of view; none for an orthographic camera.
std::optional<OtherCamera> best_other_width(const NormalPlanes& planes, const NormalScore& as) {
  const Camera& camera = planes.camera;
  if (camera.orthographic) return std::nullopt;
  std::vector<Hypothesis> hypotheses;
  for (const double factor : {0.5, 0.7, 0.85, 1.2, 1.4, 2.0}) {
    const double degrees = 2 * std::atan(0.5 * camera.width / camera.fx / factor) * 180 / std::numbers::pi;
    hypotheses.push_back({fmt::format("a field of view of about {:.0f} degrees", degrees), planes});
    auto& tangent = hypotheses.back().planes.view.tangent_per_pixel;
    tangent = {float(tangent.x / factor), float(tangent.y / factor)};
  }
  return best_of(hypotheses, as);
}

// The normals.

/// If the normals agree with depth less than this part of the best agreement, another reading of them is chosen or
/// noted.
constexpr double kNoBetter = 0.95;
/// Degrees. If the best quarter of the normals is farther off than this, normals and depth are of different cameras or
/// planes.
constexpr double kLargestAngle = 2;
/// Another camera is the right one if so many times as many normals are close to those of depth by it, and so large a
/// share more.
constexpr double kSharper = 1.2, kLeastSharper = 0.1;
/// And if so many are close at least. Of the right cameras of 13 frames the least is 38 %.
constexpr double kLeastClose = 0.3;
/// From so many on the field of view is not doubted. With half or twice the right one it was 41 % at most.
constexpr double kSurelyClose = 0.5;
/// If this part of the normals has unit length, and less than the other part by another encoding, they are vectors.
constexpr double kUnit = 0.9, kNotUnit = 0.5;
/// A reading explains the normals as well as the best one if, with those of the other side turned round, it explains
/// this part of as many, and this part of those need not be turned.
constexpr double kAsMany = 0.98, kLeastOwn = 0.2;
/// Degrees. If all normals are turned by more than this against those of depth, they are of another space or another
/// camera. Bumps do not turn them as a whole; half depth does so by up to a degree.
constexpr double kLeastTurn = 1, kLeastTurnOfHalf = 3;
/// The same where nothing but the turn speaks for another space.
constexpr double kClearTurn = 2;
/// Normals are cut if none is below this, if by depth this part of them should be, and if this part of those is as
/// depth and the cut make them.
constexpr double kBelowZero = -1.0 / 256, kLeastNeeded = 0.02, kLeastCut = 0.8;

class NormalSettlement : private Settlement {
 public:
  NormalSettlement(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen)
      : Settlement({source.reading, source.notes, settings, raw, seen, source.path_of(RawPlane::normal),
                    source.normal_file()}),
        source_(source) {}

  void run() {
    settle_encoding();
    settle_space();
  }

 private:
  std::vector<NormalScore> scores_of(NormalEncoding encoding, bool unorm) const {
    NormalPlanes read = planes();
    read.encoding = encoding;
    read.unorm = unorm;
    return score_normals(read);
  }

  static bool agrees(const NormalScore& score) {
    return score.explained() >= kLeastAgreement && score.angle <= kLargestAngle;
  }

  void settle_encoding() {
    const bool is_open = source_.open.normal_encoding;
    const NormalStatistics n = normal_statistics(raw_.normal, raw_.depth, depth_map_of(reading_), kSparse);
    if (!is_open) doubt_encoding(n);
    has_any_ = n.count > 0 || normal_statistics(raw_.normal, raw_.depth, depth_map_of(reading_)).count > 0;
    has_negative_ = n.least < kBelowZero;
    const bool in_unit_range = n.count && n.least >= 0 && n.most <= 1;
    const NormalEncoding said = reading_.normal_encoding;
    std::string why = source_.channels[RawPlane::normal].size() == 2
                          ? fmt::format("all in {:.2g} to {:.2g}", n.least, n.most)
                          : fmt::format("of unit length on {:.0f} %", 100 * n.unit_share);
    if (said == NormalEncoding::octahedral || said == NormalEncoding::spheremap ||
        source_.channels[RawPlane::normal].size() == 2) {
      reading_.normal_unorm =
          said == NormalEncoding::unorm || (in_unit_range && (is_open || said != NormalEncoding::signed_float));
    } else {
      const bool is_unorm =
          is_open && in_unit_range && n.unorm_unit_share > 0.5 && n.unit_share < 0.5 * n.unorm_unit_share;
      if (is_unorm)
        why = fmt::format("all in 0 to 1, and 2 n - 1 is of unit length on {:.0f} %", 100 * n.unorm_unit_share);
      reading_.normal_unorm = is_unorm || said == NormalEncoding::unorm;
    }
    if (has_lengths(source_)) refuse_altered(n);
    const double unit = reading_.normal_unorm ? n.unorm_unit_share : n.unit_share;
    const double otherwise = reading_.normal_unorm ? n.unit_share : n.unorm_unit_share;
    const bool tells = has_lengths(source_) && std::max(unit, otherwise) > kUnit;
    const bool differs = !tells && compare_encodings(in_unit_range, why);
    if (!is_open) return;
    const std::string name = encoding_name(reading_.normal_encoding, reading_.normal_unorm);
    if (tells && unit > kUnit && otherwise < kNotUnit)
      take_down("normal encoding", name, why, "--normal-encoding", reading_.normal_unorm, true);
    else
      guess("normal encoding", name, why, "--normal-encoding", differs || reading_.normal_unorm);
  }

  /// Refuses vectors whose lengths show that they were treated as colours.
  void refuse_altered(const NormalStatistics& n) const {
    if (std::max(n.unit_share, n.unorm_unit_share) > kUnit || n.usual_share > kUnit) return;
    if (const auto what = alteration_of(raw_, depth_map_of(reading_)))
      fail(ErrorKind::input, "{}: its normals ({}) are of unit length on {:.0f} % only: they look like {}; {}", path_,
           channels(), 100 * n.unit_share, *what, kWithout);
  }

  /// Takes normals without components below 0 if depth says that they lost some: the file does not hold the lost ones.
  /// Returns whether they are such.
  bool settle_cut(const std::vector<NormalScore>& scores) {
    if (has_negative_ || !has_lengths(source_) || reading_.normal_unorm || source_.open.camera) return false;
    const NormalScore* as = nullptr;
    CutScore best;
    for (const auto& score : scores) {
      if (to_string(score.flips) != "none" || (!source_.open.normal_space && score.space != reading_.normal_space))
        continue;
      const auto cut = score_cut(score.space, planes());
      if (!cut || cut->needed < kLeastNeeded || std::max(cut->absolute, cut->clamped) < kLeastCut) continue;
      if (as && std::max(cut->absolute, cut->clamped) <= std::max(best.absolute, best.clamped)) continue;
      best = *cut;
      as = &score;
    }
    if (!as) return false;
    const std::string why = fmt::format(
        "no component of the normals ({}) is below 0, and by depth {:.0f} % of them need one: {}; save them signed or "
        "as 0.5 + 0.5 n",
        channels(), 100 * best.needed,
        best.absolute > best.clamped ? "their absolute values were saved" : "values below 0 were cut off");
    if (as->explained() < kLeastAgreement) fail(ErrorKind::input, "{}: {}; {}", path_, why, kWithout);
    if (source_.open.normal_space) {
      reading_.normal_space = as->space;
      guess("normal space", word_of(as->space), text_of(*as), "--normal-space", false);
    }
    note(NoteCode::cut_normals, why + "; " + kWithout);
    return true;
  }

  /// As "N.X, N.Y, N.Z".
  std::string channels() const {
    std::string names;
    for (const auto& channel : source_.channels[RawPlane::normal])
      names += (names.empty() ? "" : ", ") + channel.channel;
    return names;
  }

  /// If the normals do not agree with depth, and do so much better in another encoding, that one is chosen where nobody
  /// says one, and else noted. Returns whether it was chosen.
  bool compare_encodings(bool in_unit_range, std::string& why) {
    const auto scores = scores_of(reading_.normal_encoding, reading_.normal_unorm);
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
        encoding_name(best->first, in_unit_range), best->second,
        encoding_name(reading_.normal_encoding, reading_.normal_unorm), scores[0].angle, 100 * scores[0].agreement);
    if (!source_.open.normal_encoding) {
      note(NoteCode::said_otherwise, why + ": is --normal-encoding right?");
      return false;
    }
    reading_.normal_encoding = best->first;
    reading_.normal_unorm = in_unit_range;
    return true;
  }

  /// Notes where the lengths of the normals speak against the encoding that is said.
  void doubt_encoding(const NormalStatistics& n) {
    if (source_.channels[RawPlane::normal].size() != 3) return;
    const bool is_signed = n.unit_share > kUnit && n.unorm_unit_share < kNotUnit;
    const bool is_unorm = n.unorm_unit_share > kUnit && n.unit_share < kNotUnit;
    if (is_signed && reading_.normal_encoding != NormalEncoding::signed_float)
      note(NoteCode::said_otherwise,
           fmt::format("the normals are signed vectors by their lengths (of 1 on {:.0f} %), and --normal-encoding or "
                       "the camera file says otherwise",
                       100 * n.unit_share));
    if (is_unorm && reading_.normal_encoding == NormalEncoding::signed_float)
      note(NoteCode::said_otherwise,
           fmt::format("2 n - 1 of the normals is of unit length on {:.0f} %: are they unorm (--normal-encoding)?",
                       100 * n.unorm_unit_share));
  }

  NormalPlanes planes() const { return {over(reading_, raw_.window), raw_.normal, raw_.depth}; }

  void settle_space() {
    const bool has_world = reading_.camera.view_from_world.has_value();
    // The usual reading, and that of view space where the camera knows no world.
    const bool has_usual = has_world || source_.program.normal_space == NormalSpace::view;
    if (!has_any_) {
      seen_.tells = false;
      if (source_.open.normal_space)
        reading_.normal_space = has_usual ? source_.program.normal_space : NormalSpace::view;
      return;
    }
    const auto all_scores = score_normals(planes());
    if (settle_cut(all_scores)) return;
    if (!source_.open.normal_space) return doubt_normals(all_scores);
    const std::string given = to_string(settings_.flip_normal);
    auto scores = all_scores;
    if (given != "none") std::erase_if(scores, [&](const auto& s) { return to_string(s.flips) != given; });
    const NormalScore* plain =
        score_of(scores, has_usual ? source_.program.normal_space : NormalSpace::view, settings_.flip_normal);
    const bool tells = plain && best_of(scores).explained() >= kLeastAgreement;
    if (!tells) {
      seen_.tells = false;
      if (!has_usual) refuse_without_matrix(scores);
      reading_.normal_space = source_.program.normal_space;
      guess("normal space", word_of(reading_.normal_space), "the frame does not tell", "--normal-space", false);
      return doubt_normals(all_scores);
    }
    const bool is_plain = explains(*plain, scores);
    // By a camera along an axis of the world, normals in view space look like those of a turned world.
    if (!is_plain && has_usual) refuse_turned_camera(*plain, kSharper * scores[0].close);
    const NormalScore& best = is_plain ? *plain : best_of(scores);
    const NormalScore* straighter = straighter_than(best, scores);
    if (!straighter && !is_plain) refuse_ambiguous(best, scores);
    if (!has_world && !source_.open.camera) refuse_turned_world(best);
    take(straighter ? *straighter : best, straighter ? turn_of(*straighter, best) : text_of(best), has_world);
    doubt_normals(all_scores);
  }

  /// Takes a reading, and says so where it is not the usual one, or where no matrix would turn normals of the world.
  void take(const NormalScore& score, const std::string& why, bool has_world) {
    reading_.normal_space = score.space;
    reading_.flip_normal = score.flips;
    const bool is_flipped = to_string(score.flips) != to_string(settings_.flip_normal);
    const bool is_proven = score.close > kUnit && !has_coarse_depth(reading_);
    guess("normal space", word_of(score.space), why,
          is_flipped || !has_world ? "--normal-space with --flip-normal" : "--normal-space",
          score.space != source_.program.normal_space || is_flipped, is_proven);
  }

  /// Refuses a reading where one in the other space does about as well.
  void refuse_ambiguous(const NormalScore& best, const std::vector<NormalScore>& scores) const {
    const auto other = std::ranges::find_if(scores, [&](const auto& s) { return s.space != best.space; });
    if (other == scores.end() || other->agreement < kAsGood * best.explained() || is_straighter(best, *other)) return;
    fail(ErrorKind::input,
         "{}: its normals may be in {} or in {} space ({}; {}): say which with --normal-space, and --flip-normal",
         path_, word_of(best.space), word_of(other->space), text_of(best), text_of(*other));
  }

  /// Refuses normals that are read in view space where they look like those of a world that nothing turns.
  void refuse_turned_world(const NormalScore& score) const {
    if (source_.program.normal_space == NormalSpace::view) return;
    if (const auto turned = turned_world(score))
      fail(ErrorKind::input, "{}: {}: give a --camera file with world_to_camera; {}", path_, *turned, kWithout);
  }

  /// Whether a reading does as well as any, if need be with the normals of the other side turned round: they are a
  /// fault of some objects, and flips are one of all.
  static bool explains(const NormalScore& score, const std::vector<NormalScore>& scores) {
    return score.agreement >= kNoBetter * scores[0].agreement || explains_most(score, scores);
  }
  static bool explains_most(const NormalScore& score, const std::vector<NormalScore>& scores) {
    const double most = std::ranges::max_element(scores, {}, &NormalScore::explained)->explained();
    return score.explained() >= kAsMany * most && score.agreement >= kLeastOwn * score.explained();
  }

  /// The best reading: of those that explain as many normals as any, one without flips, else the one by which most face
  /// as depth does.
  static const NormalScore& best_of(const std::vector<NormalScore>& scores) {
    const auto does = [&](const NormalScore& s) { return explains_most(s, scores); };
    const auto plain =
        std::ranges::find_if(scores, [&](const auto& s) { return does(s) && to_string(s.flips) == "none"; });
    if (plain != scores.end()) return *plain;
    const auto any = std::ranges::find_if(scores, does);
    return any != scores.end() ? *any : scores[0];
  }

  /// Whether one reading has nothing of a turn that the normals as a whole have by the other, as those of a camera that
  /// is turned by little have in the wrong space.
  bool is_straighter(const NormalScore& score, const NormalScore& other) const {
    const double least = !has_coarse_depth(reading_) ? kLeastTurn : kLeastTurnOfHalf;
    return other.turn_degrees() > least && kClear * score.turn_degrees() < other.turn_degrees() &&
           score.explained() >= kNoBetter * other.explained();
  }

  /// The same reading in the other space, where it is straighter.
  const NormalScore* straighter_than(const NormalScore& score, const std::vector<NormalScore>& scores) const {
    const auto other = score.space == NormalSpace::world ? NormalSpace::view : NormalSpace::world;
    const NormalScore* reading = score_of(scores, other, score.flips);
    return reading && is_straighter(*reading, score) ? reading : nullptr;
  }

  static std::string turn_of(const NormalScore& chosen, const NormalScore& other) {
    return fmt::format(
        "as those of {} space the normals as a whole are turned by {:.1f} degrees against depth, as {} "
        "by {:.1f}",
        word_of(other.space), other.turn_degrees(), word_of(chosen.space), chosen.turn_degrees());
  }

  /// Tells whether normals that are read in view space are those of a world in which the camera is turned by little, if
  /// no matrix places it.
  std::optional<std::string> turned_world(const NormalScore& score) const {
    const double least = !has_coarse_depth(reading_) ? kClearTurn : kLeastTurnOfHalf;
    if (reading_.camera.view_from_world || score.space != NormalSpace::view || score.turn_degrees() < least)
      return std::nullopt;
    const auto turned = slightly_turned_camera(planes(), score);
    if (!turned) return std::nullopt;
    const NormalScore& then = turned->score;
    if (then.close <= kSharper * score.close && (score.angle <= kLargestAngle || kClear * then.angle >= score.angle))
      return std::nullopt;
    const auto width = best_other_width(planes(), score);
    if (width && width->score.close >= then.close) return std::nullopt;
    return fmt::format(
        "its normals look like those of world space by {}: {:.0f} % of them agree with depth to 3 degrees then, {:.0f} "
        "% in view space",
        turned->what, 100 * then.close, 100 * score.close);
  }

  /// Refuses normals that are not those of view space where no matrix turns those of the world.
  [[noreturn]] void refuse_without_matrix(const std::vector<NormalScore>& scores) const {
    if (!source_.program.by.empty()) throw NoWorldToCamera(path_);
    fail(
        ErrorKind::input,
        "{}: {:.0f} % of its normals at most agree with depth in view space; those of world space need a --camera file "
        "with world_to_camera; if they are in view space, {}; {}",
        path_, scores.empty() ? 0 : 100 * scores[0].agreement, kCheck, kWithout);
  }

  static std::string text_of(const NormalScore& s) {
    return fmt::format("{} with flips {}: {:.0f} % agree with depth, {:.0f} % face the camera{}", word_of(s.space),
                       to_string(s.flips), 100 * s.agreement, 100 * s.facing,
                       s.opposite < 0.005 ? "" : fmt::format(", {:.0f} % are opposite to depth", 100 * s.opposite));
  }

  /// Notes normals that depth speaks against, and refuses normals that it refutes.
  void doubt_normals(const std::vector<NormalScore>& scores) {
    if (source_.open.camera) return;
    const NormalScore* chosen = score_of(scores, reading_.normal_space, reading_.flip_normal);
    if (!chosen) return;
    const NormalScore* straighter = straighter_than(*chosen, scores);
    if (straighter)
      return note(NoteCode::normals_disagree,
                  fmt::format("normals are read as {}; better fits {}: {} ({})", text_of(*chosen), text_of(*straighter),
                              turn_of(*straighter, *chosen), kSpaceOptions));
    note_other_cause(*chosen, scores);
    doubt_centre(*chosen);
    if (doubt_rotation(*chosen)) return;
    if (chosen->explained() < kLeastAgreement || chosen->agreement < kRefuted) refuse_normals(*chosen, scores[0]);
    if (scores[0].agreement >= kLeastAgreement && !explains(*chosen, scores))
      note(NoteCode::normals_disagree, fmt::format("normals are read as {}; better fits {} ({})", text_of(*chosen),
                                                   text_of(scores[0]), kSpaceOptions));
    else if (chosen->explained() < kLeastAgreement)
      note(NoteCode::normals_disagree, fmt::format("only {:.0f} % of the normals agree with depth, read as {}: {}",
                                                   100 * chosen->agreement, text_of(*chosen), kCheck));
    else if (const auto turned = turned_world(*chosen))
      note(NoteCode::normals_disagree, fmt::format("{} ({})", *turned, kSpaceOptions));
    else if (!doubt_width(*chosen) && !agrees(*chosen) && !has_coarse_depth(reading_))
      note(NoteCode::normals_disagree,
           fmt::format("even the best quarter of the normals is up to {:.1f} degrees off those of depth: {}",
                       chosen->angle, kCheck));
  }

  /// Notes that normals which are turned round may be those of a flipped axis: depth fits both ways alike.
  void note_other_cause(const NormalScore& chosen, const std::vector<NormalScore>& scores) {
    const auto other = std::ranges::find_if(
        scores, [&](const auto& s) { return s.space == chosen.space && s.agreement >= kAsMany * chosen.explained(); });
    if (other == scores.end() || chosen.agreement >= kAsMany * other->agreement) return;
    note(NoteCode::turned_normals,
         fmt::format("{:.0f} % of the normals are opposite to depth and are turned round, as for mirrored things; if "
                     "an axis of all normals is flipped, as in DirectX, give --flip-normal {}",
                     100 * chosen.opposite, to_string(other->flips)));
  }

  /// Whether one camera fits so much better than another that it is no chance.
  static bool is_sharper(const NormalScore& other, const NormalScore& score) {
    return other.close >= kLeastClose && other.close > kSharper * score.close &&
           other.close > score.close + kLeastSharper;
  }

  /// Refuses normals that hardly agree with depth, where another reading or another camera has clearly more of them
  /// agree, or where nothing is left that could be right.
  void refuse_normals(const NormalScore& chosen, const NormalScore& best) const {
    refuse_turned_camera(chosen, best.close);
    const std::string read =
        fmt::format("{}: its normals, read as {}, are not those of this depth and this camera", path_, text_of(chosen));
    if (best.agreement >= kLeastAgreement && best.agreement > kClear * chosen.agreement)
      fail(ErrorKind::input, "{}: as {} ({}); {}", read, text_of(best), kSpaceOptions, kWithout);
    // Coarse depth turns the normals of depth themselves by so much.
    if (chosen.explained() < kRefuted && !has_coarse_depth(reading_))
      fail(ErrorKind::input, "{}, nor in any other space: {}; {}", read, kCheck, kWithout);
  }

  /// Refuses the camera where the normals agree with depth by one that is turned in a usual way, and by the given one
  /// do not. `sharpest` is the share that another reading of the normals brings close.
  void refuse_turned_camera(const NormalScore& chosen, double sharpest) const {
    const auto turned = best_turned_camera(planes(), chosen);
    if (!turned || turned->score.agreement < kLeastAgreement || turned->score.close < sharpest ||
        turned->score.agreement < kClear * chosen.agreement)
      return;
    fail(ErrorKind::input,
         "{}: the camera{} does not fit: by it {:.0f} % of the normals in {} space agree with depth; {}, then {:.0f} % "
         "agree; {}",
         path_, from(), 100 * chosen.agreement, word_of(chosen.space), turned->what, 100 * turned->score.agreement,
         kWithout);
  }

  /// Refuses a principal point that fits elsewhere, and says where no pixel can tell.
  void doubt_centre(const NormalScore& chosen) {
    if (!is_off_centre(reading_.camera)) return;
    const auto other = best_other_point(planes(), chosen);
    if (!other) return;
    if (is_sharper(other->score, chosen))
      fail(ErrorKind::input,
           "{}: the camera{} does not fit: by it {:.0f} % of the normals agree with depth to 3 degrees; {}, then "
           "{:.0f} % do; {}",
           path_, from(), 100 * chosen.close, other->what, 100 * other->score.close, kWithout);
    if (is_sharper(chosen, other->score)) return;
    note_centre(source_);
  }

  /// Notes where the angles of a .chan file fit better in another order. Returns whether they do.
  bool doubt_rotation(const NormalScore& chosen) {
    const auto other = best_other_rotation(planes(), chosen);
    if (!other || !is_sharper(other->score, chosen) || chosen.agreement < kLeastAgreement) return false;
    note(NoteCode::normals_disagree,
         fmt::format("by the camera{} {:.0f} % of the normals agree with depth to 3 degrees; {}, then {:.0f} % do",
                     from(), 100 * chosen.close, other->what, 100 * other->score.close));
    return true;
  }

  /// Notes where another field of view fits better, as it also may where the depth is read wrongly. Returns whether it
  /// does.
  bool doubt_width(const NormalScore& chosen) {
    if (chosen.close >= kSurelyClose) return false;
    const auto other = best_other_width(planes(), chosen);
    if (!other || !is_sharper(other->score, chosen)) return false;
    note(NoteCode::field_of_view,
         fmt::format("{} fits the normals better: {:.0f} % of them agree with depth to 3 degrees then, {:.0f} % as it "
                     "is given: {}",
                     other->what, 100 * other->score.close, 100 * chosen.close, kCheck));
    return true;
  }

  /// Names the file of the camera, or the header's attributes.
  std::string from() const {
    if (!source_.camera_from.empty()) return " of " + source_.camera_from;
    return settings_.camera.empty() ? std::string() : " " + settings_.camera;
  }

  static constexpr const char* kSpaceOptions = "--normal-space, --flip-normal";
  static constexpr const char* kWithout = "--normal none reconstructs them from depth";

  static constexpr const char* kCheck =
      "check --normal-space, --normal-encoding, --depth-kind with --near, --far and --reversed-z, and --camera, "
      "--chan-rotation or --fov: "
      "it may also be the camera of another frame";

  FrameSource& source_;
  bool has_any_ = true;        // a normal that is no sky's
  bool has_negative_ = false;  // of the normals' components as they stand in the file, any
};

}  // namespace

const char* encoding_name(NormalEncoding encoding, bool unorm) {
  if (encoding == NormalEncoding::octahedral) return "octahedral";
  if (encoding == NormalEncoding::spheremap) return "spheremap";
  return unorm ? "unorm" : "signed";
}

void note_centre(FrameSource& source) {
  // A renderer writes its own camera into headers.
  if (source.open.camera || !source.camera_from.empty() || !is_off_centre(source.reading.camera)) return;
  source.notes.push_back(
      {NoteCode::principal_point,
       fmt::format("the principal point is at ({:.6g}, {:.6g}) of {} x {} pixels, and no pixel shows whether it is on "
                   "the right side of the centre",
                   source.reading.camera.cx, source.reading.camera.cy, source.reading.camera.width,
                   source.reading.camera.height)});
}

void settle_normals(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen) {
  NormalSettlement(source, settings, raw, seen).run();
}

}  // namespace alcove
