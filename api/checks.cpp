// Asks the pixels, as for frames from files; nothing is guessed here, since whoever has planes knows what they are.
// SPDX-License-Identifier: BSD-3-Clause
#include "api/session.h"

#include <algorithm>
#include <cmath>

#include "core/frame/pixels/detectors.h"
#include "core/frame/pixels/normal_scores.h"
#include "core/frame/pixels/radius.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/settle/depth_settlement.h"
#include "core/frame/settle/other_cameras.h"
#include "core/frame/settle/precision.h"

namespace alcove {
namespace {

constexpr double kUnit = 0.9, kFew = 0.5;  // shares of normals of unit length that tell an encoding
constexpr std::size_t kStep = 16;          // one pixel of so many is looked at

/// Refuses values that are no depth of their kind at all.
void check_depth(const Reading& reading, std::span<const float> depth) {
  const auto is_surface = [&](float z) { return z > 0 && z < reading.sky; };
  const auto is_negative = [](float z) { return std::isfinite(z) && z < 0; };
  if (is_distance(reading.depth_kind) && std::ranges::none_of(depth, is_surface) &&
      std::ranges::any_of(depth, is_negative))
    fail(ErrorKind::input, "depth: all surfaces have negative values: distances are positive, so give -depth");
  const auto is_fraction = [](float z) { return z > -1 && z < 1 && z != 0; };
  const auto is_beyond = [](float z) { return std::isfinite(z) && z > 1; };
  if (is_between_planes(reading.depth_kind) && std::ranges::none_of(depth, is_fraction) &&
      std::ranges::any_of(depth, is_beyond))
    fail(ErrorKind::input,
         "depth: {} depth lies within 0 to 1, and no value does: divide integers by their largest one",
         word_of(reading.depth_kind));
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
  if (lacks_sign(normal.size() / reading.data.pixels(), reading.normal_encoding) &&
      reading.normal_space == NormalSpace::world)
    fail(ErrorKind::input,
         "normal: two components do not tell the sign of z in world space: give three, or set --normal-space view, or "
         "--normal-encoding octahedral or spheremap");
  const auto scores = score_normals({reading, normal, depth});
  const NormalScore* chosen = score_of(scores, reading.normal_space, reading.flip_normal);
  if (!chosen || chosen->agreement >= kLeastAgreement) return;
  const std::string said =
      fmt::format("normal: {:.0f} % agree with depth, in {} space", 100 * chosen->agreement, word_of(chosen->space));
  if (scores[0].clearly_beats(*chosen)) fail(ErrorKind::input, "{}; better fits {}", said, text_of(scores[0]));
  const auto turned = best_turned_camera({reading, normal, depth}, *chosen);
  if (turned && turned->score.clearly_beats(*chosen))
    fail(ErrorKind::input, "{}; {}, then {:.0f} % agree", said, turned->what, 100 * turned->score.agreement);
  const std::string check = "check --normal-space, --normal-encoding and the camera";
  if (chosen->explained() < kUsable && !reading.depth_is_half)
    fail(ErrorKind::input, "{}, and no more in another space: {}; without the plane, normals are those of depth", said,
         check);
  notes.push_back({NoteCode::normals_disagree, said + ": " + check});
}

}  // namespace

Notes check_planes(Reading& reading, const HostPlanes& planes, const InputSettings& settings) {
  const auto depth = planes[RawPlane::depth], normal = planes[RawPlane::normal];
  const std::string name = reading.depth_kind == DepthKind::position ? "position" : "depth";
  check_depth(reading, depth);
  const RawPart raw{reading.data, depth, normal};
  Notes notes;
  Evidence seen;
  DepthFacts said;
  said.program.rules = &input_rules("generic");
  said.said_by = "--depth-kind, the camera or default";
  seen.grain = measure_rounding(reading, raw.window, depth, name);
  settle_depth({reading, notes, settings, raw, seen, name}, said);
  // Coarse disparity has been held against them for its shift, which is all that it can tell.
  if (!normal.empty() && !seen.space_by_shift) check_normals(reading, planes, notes);
  add_new(notes, detected(findings_of(reading, raw, seen, name, true)));
  measure_levels(reading, depth);
  return notes;
}

Notes check_radius(const Reading& reading, std::span<const float> depth, const EstimatorSettings& settings) {
  if (!settings.radius) return {};
  DepthSample sample;
  sample.add(view_of(reading, reading.data), depth_map_of(reading), depth_precision_of(reading), depth);
  const auto radii = radii_of(settings);
  return sample.notes(radii.front(), radii.back(), reading.data.width, reading.data.height);
}

}  // namespace alcove
