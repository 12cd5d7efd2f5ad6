// Asks the pixels, as for frames from files; nothing is guessed here, since whoever has planes knows what they are.
// SPDX-License-Identifier: BSD-3-Clause
#include "api/session.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/chain/estimate/estimate.h"
#include "core/frame/pixels/normal_scores.h"
#include "core/frame/pixels/radius.h"
#include "core/frame/pixels/statistics.h"

namespace alcove {
namespace {

constexpr double kUnit = 0.9, kFew = 0.5;  // shares of normals of unit length that tell an encoding
constexpr double kFarOff = 2;              // px, of the median position from its pixel
constexpr std::size_t kStep = 16;          // one pixel of so many is looked at

void check_depth(const Reading& reading, std::span<const float> depth, const View& view) {
  if (reading.depth_kind == DepthKind::position) {
    const auto error = reprojection_error(depth, reading.position_space, false, reading.camera, view);
    if (error && *error > kFarOff)
      fail(ErrorKind::input,
           "position: half of the positions are more than {:.3g} px from their pixels, or behind the camera, which "
           "looks along -z: check --set position-space and the camera",
           *error);
    return;
  }
  const auto is_surface = [&](float z) { return z > 0 && z < reading.sky; };
  const auto is_negative = [](float z) { return std::isfinite(z) && z < 0; };
  if (is_distance(reading.depth_kind) && std::ranges::none_of(depth, is_surface) &&
      std::ranges::any_of(depth, is_negative))
    fail(ErrorKind::input, "depth: all surfaces have negative values: distances are positive, so give -depth");
}

std::string text_of(const NormalScore& score) {
  const std::string flips = to_string(score.flips);
  return fmt::format("--normal-space {}{} ({:.0f} % agree)", word_of(score.space),
                     flips == "none" ? "" : " with --flip-normal " + flips, 100 * score.agreement);
}

void check_normals(const Reading& reading, const HostPlanes& planes, Notes& notes) {
  const auto normal = planes[RawPlane::normal], depth = planes[RawPlane::depth];
  const DepthMap map = depth_map_of(reading);
  const bool has_vectors = normal.size() == 3 * reading.data.pixels() &&
                           reading.normal_encoding != NormalEncoding::octahedral &&
                           reading.normal_encoding != NormalEncoding::spheremap;
  const NormalStatistics lengths = normal_statistics(normal, depth, map, kStep);
  if (has_vectors && !reading.normal_unorm && lengths.unorm_unit_share > kUnit && lengths.unit_share < kFew)
    fail(ErrorKind::input, "normal: 2 n - 1 is of unit length on {:.0f} %, and n is not: set --normal-encoding unorm",
         100 * lengths.unorm_unit_share);
  if (has_vectors && reading.normal_unorm && lengths.unit_share > kUnit && lengths.unorm_unit_share < kFew)
    fail(ErrorKind::input, "normal: n is of unit length on {:.0f} %, and 2 n - 1 is not: set --normal-encoding signed",
         100 * lengths.unit_share);
  const auto scores = score_normals({reading, normal, depth});
  const NormalScore* chosen = score_of(scores, reading.normal_space, reading.flip_normal);
  if (!chosen || chosen->agreement >= kLeastAgreement) return;
  const std::string said =
      fmt::format("normal: {:.0f} % agree with depth, in {} space", 100 * chosen->agreement, word_of(chosen->space));
  if (scores[0].agreement >= kLeastAgreement && scores[0].agreement > kClear * chosen->agreement)
    fail(ErrorKind::input, "{}; better fits {}", said, text_of(scores[0]));
  const std::string check = "check --normal-space, --normal-encoding and the camera";
  if (chosen->agreement < kRefuted && !reading.depth_is_half)
    fail(ErrorKind::input, "{}, and no more in another space: {}", said, check);
  notes.push_back({NoteCode::normals_disagree, said + ": " + check});
}

}  // namespace

Notes check_planes(const Reading& reading, const HostPlanes& planes, const EstimatorSettings& settings) {
  const View view = view_of(reading.camera, reading.data, reading.display);
  const auto depth = planes[RawPlane::depth];
  check_depth(reading, depth, view);
  Notes notes;
  if (!planes[RawPlane::normal].empty()) check_normals(reading, planes, notes);
  if (settings.radius) {
    DepthSample sample;
    sample.add(view, depth_map_of(reading), depth_precision_of(reading), depth);
    const auto radii = radii_of(settings);
    add_new(notes, sample.notes(radii.front(), radii.back(), reading.data.width, reading.data.height));
  }
  return notes;
}

}  // namespace alcove
