// Tries other components on the normals.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/other_components.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/samples.h"
#include "core/frame/settle/normal_settlement.h"
#include "core/frame/settle/settle.h"

namespace alcove {
namespace {

using Places = std::vector<std::size_t>;

/// The sharpest reading of these components that is one of the frame's depth.
std::optional<OtherComponents> tried(NormalPlanes planes, const Places& channels, NormalEncoding encoding, bool unorm) {
  planes.components = channels;
  planes.encoding = encoding;
  planes.unorm = unorm;
  std::optional<OtherComponents> best;
  for (const NormalScore& score : score_normals(planes)) {
    if (!score.may_be_right() || (best && score.close <= best->score.close)) continue;
    best = OtherComponents{channels, encoding, unorm, score};
  }
  return best;
}

}  // namespace

std::optional<OtherComponents> best_other_components(const NormalPlanes& planes, bool are_vectors,
                                                     const NormalScore& score) {
  const std::array<Places, 5> orders{{{2, 1, 0}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}}};
  std::vector<std::optional<OtherComponents>> all;
  if (are_vectors)
    for (const Places& order : orders) all.push_back(tried(planes, order, planes.encoding, planes.unorm));
  for (const bool unorm : {false, true})
    if (!are_vectors)
      for (const auto encoding : {NormalEncoding::octahedral, NormalEncoding::spheremap, NormalEncoding::signed_float})
        all.push_back(tried(planes, {0, 1}, encoding, unorm));
  std::optional<OtherComponents> best;
  for (const auto& other : all)
    if (other && is_sharper(other->score, score) && (!best || other->score.close > best->score.close)) best = other;
  return best;
}

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

bool are_alike(const RawPart& raw, const DepthMap& map) {
  constexpr double kAlike = 0.98;  // length of the mean of the unit vectors
  const std::size_t pixels = raw.window.pixels(), step = even_step(raw.window, kNormalPixels);
  std::array<Vector3, 2> sums{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < pixels; i += step) {
    if (std::isinf(planar_depth(map, value_at(raw.depth, pixels, i), 1))) continue;
    std::size_t unorm = 0;
    for (Vector3& sum : sums) {
      const Vector3 n = decoded_normal(raw.normal, pixels, i, NormalEncoding::signed_float, unorm++ > 0);
      const double size = length(n);
      for (std::size_t c = 0; c < 3 && size > 0; c++) sum[c] += n[c] / size;
    }
    count++;
  }
  return std::ranges::any_of(sums, [&](const Vector3& sum) { return length(sum) > kAlike * double(count); });
}

namespace {

class OtherChannels : private NormalSettlement {
 public:
  explicit OtherChannels(const NormalSettlement& normals) : NormalSettlement(normals) {}

  void refuse(const std::vector<NormalScore>& scores, const NormalStatistics& n) const {
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
      refuse_turned_camera(*this, *usual, kSharper * score.close);
    fail(ErrorKind::input, "{}: {}; {}", path_, text_of(*other, score), kWithout);
  }

 private:
  std::string text_of(const OtherComponents& other, const NormalScore& score) const {
    const auto& all = source_.channels[RawPlane::normal];
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
};

}  // namespace

void refuse_other_components(const NormalSettlement& normals, const std::vector<NormalScore>& scores,
                             const NormalStatistics& statistics) {
  OtherChannels(normals).refuse(scores, statistics);
}

}  // namespace alcove
