// Settles the encoding of normals, tells vectors that went through what pictures go through, and tries other
// components.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/samples.h"
#include "core/frame/settle/normal_settlement.h"
#include "core/frame/settle/settle.h"

namespace alcove {
namespace {

// Alterations that destroy the unit length of normals.

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

// The encoding.

/// The place of a channel that has one value on all surfaces while the two others vary, and that value.
struct ConstantComponent {
  std::size_t channel;
  float value;
  double bare;  // the share of surfaces without a normal
};
std::optional<ConstantComponent> constant_component(const RawPart& raw, const DepthMap& map) {
  constexpr float kSame = 1e-3f;
  const auto normal = raw.normal;
  const std::size_t pixels = raw.window.pixels(), step = even_step(raw.window, kNormalPixels);
  std::array<float, 3> least{}, most{};
  std::size_t surfaces = 0, bare = 0;
  least.fill(INFINITY);
  most.fill(-INFINITY);
  for (std::size_t i = 0; i < pixels; i += step) {
    if (std::isinf(planar_depth(map, value_at(raw.depth, pixels, i), 1))) continue;
    const std::array n{normal[i], normal[i + pixels], normal[i + 2 * pixels]};
    surfaces++;
    bare += std::ranges::all_of(n, [](float v) { return v == 0 || !std::isfinite(v); });
    if (n == std::array{0.0f, 0.0f, 0.0f}) continue;
    for (std::size_t c = 0; c < 3; c++) least[c] = std::min(least[c], n[c]), most[c] = std::max(most[c], n[c]);
  }
  const auto is_constant = [&](std::size_t c) { return most[c] - least[c] < kSame; };
  for (const std::size_t c : {std::size_t(2), std::size_t(0), std::size_t(1)})
    if (is_constant(c) && !is_constant((c + 1) % 3) && !is_constant((c + 2) % 3))
      return ConstantComponent{c, least[c], double(bare) / double(surfaces)};
  return std::nullopt;
}

class EncodingSettlement : private NormalSettlement {
 public:
  explicit EncodingSettlement(const NormalSettlement& normals) : NormalSettlement(normals) {}

  NormalStatistics run() {
    const bool is_open = source_.open.normal_encoding;
    NormalStatistics n =
        normal_statistics(raw_.normal, raw_.depth, depth_map_of(reading_), even_step(raw_.window, kNormalPixels));
    if (n.count == 0) n = normal_statistics(raw_.normal, raw_.depth, depth_map_of(reading_));
    if (!is_open) doubt_encoding(n);
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
    if (has_lengths(source_)) refuse_missing(n);
    if (!is_open) return n;
    const std::string name = encoding_name(reading_.normal_encoding, reading_.normal_unorm);
    if (tells && unit > kUnit && otherwise < kNotUnit)
      take_down("normal encoding", name, why, "--normal-encoding", reading_.normal_unorm, true);
    else
      guess("normal encoding", name, why, "--normal-encoding", differs || reading_.normal_unorm);
    return n;
  }

 private:
  std::vector<NormalScore> scores_of(NormalEncoding encoding, bool unorm) const {
    NormalPlanes read = planes();
    read.encoding = encoding;
    read.unorm = unorm;
    return score_normals(read);
  }

  /// Refuses two components that were saved as three: the third one has one value, and lengths are not 1.
  void refuse_missing(const NormalStatistics& n) const {
    constexpr double kMostBare = 0.02;  // of the surfaces
    constexpr double kUnitAxes = 0.97;  // from there on only normals along the third axis can be missing, and are 0
    const auto missing = constant_component(raw_, depth_map_of(reading_));
    if (!missing) return;
    const double unit = std::max(n.unit_share, n.unorm_unit_share);
    if (unit > kUnitAxes || (unit > kNotUnit && missing->bare < kMostBare)) return;
    refuse_other_components({}, {});
    const auto& all = source_.channels[RawPlane::normal];
    fail(ErrorKind::input,
         "{}: {} is {:.3g} everywhere, so its normals lack a component: name the other two channels (--normal-channels "
         "{},{}) to rebuild z in view space; --normal-encoding octahedral or spheremap reads two channels in any "
         "space; {}",
         path_, all[missing->channel].channel, missing->value, all[missing->channel == 0 ? 1 : 0].channel,
         all[missing->channel == 2 ? 1 : 2].channel, kWithout);
  }

  /// Refuses vectors whose lengths show that they were treated as colours.
  void refuse_altered(const NormalStatistics& n) const {
    if (std::max(n.unit_share, n.unorm_unit_share) > kUnit || n.usual_share > kUnit) return;
    if (const auto what = alteration_of(raw_, depth_map_of(reading_)))
      fail(ErrorKind::input, "{}: its normals ({}) are of unit length on {:.0f} % only: they look like {}; {}", path_,
           channels(), 100 * n.unit_share, *what, kWithout);
  }

  /// If the normals do not agree with depth, and do so much better in another encoding, that one is chosen where nobody
  /// says one, and else noted. Returns whether it was chosen.
  bool compare_encodings(bool in_unit_range, std::string& why) {
    const auto scores = scores_of(reading_.normal_encoding, reading_.normal_unorm);
    if (scores.empty()) return false;
    const NormalScore* const own = sharpest_of(scores);
    const NormalScore& as_is = own ? *own : scores[0];
    if (agrees(as_is) && as_is.close > kUnit) return false;
    std::optional<std::pair<NormalEncoding, NormalScore>> best;
    for (const auto encoding : {NormalEncoding::signed_float, NormalEncoding::octahedral, NormalEncoding::spheremap}) {
      const auto others = scores_of(encoding, in_unit_range);
      const NormalScore* const other = sharpest_of(others);
      if (!other || !agrees(*other) || (best && other->close <= best->second.close)) continue;
      if (is_sharper(*other, as_is) || as_is.agreement < kAsGood * other->agreement) best = {encoding, *other};
    }
    if (!best) return false;
    why = fmt::format(
        "as {} {:.0f} % of the normals agree with depth within 3 degrees, as {} {:.0f} %, and {:.0f} % agree "
        "at all",
        encoding_name(best->first, in_unit_range), 100 * best->second.close,
        encoding_name(reading_.normal_encoding, reading_.normal_unorm), 100 * as_is.close, 100 * as_is.agreement);
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
};

// Other components.

using Places = std::vector<std::size_t>;

/// Tried channels, by their places among the three, and their reading.
struct OtherComponents {
  Places channels;
  NormalEncoding encoding;
  bool unorm;
  NormalScore score;
};

/// Gives the order of vector components, or else the encoding of the first two channels, with the most normals within 3
/// degrees of depth. None if no order is clearly better than `score`, or if too little of the frame is smooth.
std::optional<OtherComponents> best_other_components(NormalPlanes planes, bool are_vectors, const NormalScore& score) {
  std::optional<OtherComponents> best;
  const auto consider = [&](const Places& channels) {
    planes.components = channels;
    for (const NormalScore& other : score_normals(planes))
      if (other.may_be_right() && is_sharper(other, score) && (!best || other.close > best->score.close))
        best = OtherComponents{channels, planes.encoding, planes.unorm, other};
  };
  if (are_vectors)
    for (const Places& order : {Places{2, 1, 0}, Places{0, 2, 1}, Places{1, 0, 2}, Places{1, 2, 0}, Places{2, 0, 1}})
      consider(order);
  if (are_vectors) return best;
  for (const bool unorm : {false, true})
    for (const auto encoding : {NormalEncoding::octahedral, NormalEncoding::spheremap, NormalEncoding::signed_float}) {
      planes.encoding = encoding;
      planes.unorm = unorm;
      consider({0, 1});
    }
  return best;
}

/// `all`: the channels of the normals.
std::string components_text(const OtherComponents& other, const NormalScore& score,
                            const std::vector<ChannelRef>& all) {
  std::string names;
  for (const std::size_t channel : other.channels) names += (names.empty() ? "" : ",") + all[channel].channel;
  const bool is_encoded = other.encoding == NormalEncoding::octahedral || other.encoding == NormalEncoding::spheremap;
  return fmt::format(
      "its normals have {}: as {} {:.0f} % of them agree with depth to 3 degrees, as they stand {:.0f} %: give "
      "--normal-channels {}{}",
      other.channels.size() == 2 ? "two components" : "another order of components", names, 100 * other.score.close,
      100 * score.close, names,
      is_encoded ? fmt::format(" --normal-encoding {}", encoding_name(other.encoding, other.unorm)) : "");
}

}  // namespace

const char* encoding_name(NormalEncoding encoding, bool unorm) {
  if (encoding == NormalEncoding::octahedral) return "octahedral";
  if (encoding == NormalEncoding::spheremap) return "spheremap";
  return unorm ? "unorm" : "signed";
}

NormalStatistics settle_normal_encoding(const NormalSettlement& normals) { return EncodingSettlement(normals).run(); }

void NormalSettlement::refuse_other_components(const std::vector<NormalScore>& scores,
                                               const NormalStatistics& n) const {
  constexpr double kGood = 0.8;     // close to depth: no other order has so many more
  constexpr double kVectors = 0.5;  // of unit length
  const auto& all = source_.channels[RawPlane::normal];
  const NormalScore* sharpest = sharpest_of(scores);
  const NormalScore score = sharpest ? *sharpest : scores.empty() ? NormalScore{} : scores[0];
  if (all.size() != 3 || source_.open.camera || has_coarse_depth(reading_) || score.close > kGood) return;
  const bool are_vectors = (reading_.normal_unorm ? n.unorm_unit_share : n.unit_share) > kVectors;
  if (!are_vectors && !source_.open.normal_encoding) return;  // another one is named elsewhere
  NormalPlanes sparse = planes();
  sparse.sparse = 4;
  const auto other = best_other_components(sparse, are_vectors, score);
  if (!other) return;
  // Another axis up looks like another order.
  if (const NormalScore* usual = score_of(scores, source_.program.normal_space, settings_.flip_normal))
    refuse_turned_camera(*usual, kSharper * score.close);
  fail(ErrorKind::input, "{}: {}; {}", path_, components_text(*other, score, all), kWithout);
}

}  // namespace alcove
