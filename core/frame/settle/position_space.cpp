// Settles the space of positions.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/settle/depth_settlement.h"

namespace alcove {
namespace {

/// Pixels. If the median is farther off than this, positions are no positions of this space and camera.
constexpr double kLargestError = 2;

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

void settle_position_space(const PlanesToSettle& planes) { PositionSettlement(planes).run(); }

}  // namespace alcove
