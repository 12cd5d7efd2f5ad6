// Where each estimator's numbers fail: its error against the double-precision reference along every axis, and whether a
// run would say so.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/base/note.h"
#include "core/gpu/device_info.h"

namespace alcove {
namespace gpu {
class Device;
}

/// An estimator breaks down where its RMSE is this much above its RMSE in the plain room, the error of its samples
/// alone.
constexpr double kBreakdown = 0.05;

struct StabilityPoint {
  double at = 0;
  Notes notes = {};  // by `alcove run`, for this frame and radius
};

/// An estimator along an axis.
struct StabilityCurve {
  std::string estimator;
  std::vector<double> rmse;  // at each of the axis' points, over the surfaces
  // the points nearest to the plain room, to each side of it, that break down; none: nowhere
  std::vector<std::size_t> breaks;
  bool said = false;  // at all of them a run says so
};

struct StabilityAxis {
  std::string name, unit;
  std::vector<StabilityPoint> points;
  std::vector<StabilityCurve> curves;
};

struct StabilityReport {
  std::string device;
  std::vector<std::pair<std::string, double>> plain;  // each estimator and its RMSE in the plain room
  std::vector<StabilityAxis> axes;
};

/// Which of it to measure.
struct StabilityPart {
  std::vector<std::string> axes = {};  // their names; empty: all
  // of each axis, > 1: the first, the last, and others evenly between them
  std::size_t most_points = std::numeric_limits<std::size_t>::max();
};

/// Measures the axes, all of them in a minute or so on a CPU. `say`: progress, a line each; may be empty.
StabilityReport run_stability(gpu::Device& device, const std::function<void(const std::string&)>& say,
                              const StabilityPart& part = {});

/// A line for every axis and estimator: the worst error and where it breaks down.
std::string stability_text(const StabilityReport& report);
/// {"device", "breakdown", "plain": [{"estimator", "rmse"}], "axes": [{"name", "unit", "points": [{"at", "notes"}],
/// "curves": [{"estimator", "rmse", "breaks_at": [...], "said"}]}]}.
std::string stability_json(const StabilityReport& report);
/// The page of core/measure/report.h, with a row for each point and estimator.
std::string stability_page(const StabilityReport& report);

}  // namespace alcove
