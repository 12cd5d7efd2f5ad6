// Tries other components on the normals.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <vector>

#include "core/base/error.h"
#include "core/frame/settle/normal_settlement.h"
#include "core/frame/settle/settle.h"

namespace alcove {
namespace {

using Places = std::vector<std::size_t>;

/// Tried channels, by their places among the three, and their reading.
struct OtherComponents {
  std::vector<std::size_t> channels;
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
