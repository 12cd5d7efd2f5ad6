// The stability report as text, JSON and a page.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/bench/stability.h"
#include "core/measure/report.h"

namespace alcove {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinity and no NaN.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double worst_of(const StabilityCurve& curve) { return *std::ranges::max_element(curve.rmse); }

/// Where the curve breaks down: values of the axis.
std::string places_of(const StabilityAxis& axis, const StabilityCurve& curve) {
  std::vector<std::string> places;
  for (const std::size_t i : curve.breaks) places.push_back(fmt::format("{:g}", axis.points[i].at));
  return fmt::format("{}", fmt::join(places, ", "));
}

std::string breaks_text(const StabilityAxis& axis, const StabilityCurve& curve) {
  if (curve.breaks.empty()) return "-";
  return places_of(axis, curve) + (curve.said ? ", said" : ", NOT said");
}

}  // namespace

std::string stability_text(const StabilityReport& report) {
  std::string text = fmt::format("{:<28} {:<16} {:>10} {}\n", "axis", "estimator", "worst", "breaks down at");
  for (const auto& axis : report.axes)
    for (const auto& curve : axis.curves)
      text += fmt::format("{:<28} {:<16} {:>10.4f} {}\n", axis.name, curve.estimator, worst_of(curve),
                          breaks_text(axis, curve));
  return text;
}

std::string stability_json(const StabilityReport& report) {
  Json plain = Json::array(), axes = Json::array();
  for (const auto& [estimator, rmse] : report.plain)
    plain.push_back({{"estimator", estimator}, {"rmse", number(rmse)}});
  for (const auto& axis : report.axes) {
    Json points = Json::array(), curves = Json::array();
    for (const auto& point : axis.points) points.push_back({{"at", point.at}, {"notes", texts_of(point.notes)}});
    for (const auto& curve : axis.curves) {
      Json rmse = Json::array(), breaks = Json::array();
      for (const double value : curve.rmse) rmse.push_back(number(value));
      for (const std::size_t i : curve.breaks) breaks.push_back(axis.points[i].at);
      curves.push_back({{"estimator", curve.estimator}, {"rmse", rmse}, {"breaks_at", breaks}, {"said", curve.said}});
    }
    axes.push_back({{"name", axis.name}, {"unit", axis.unit}, {"points", points}, {"curves", curves}});
  }
  return json_text({{"device", report.device}, {"breakdown", kBreakdown}, {"plain", plain}, {"axes", axes}}, 1) + "\n";
}

std::string stability_page(const StabilityReport& report) {
  Json candidates = Json::array(), rows = Json::array();
  for (std::size_t c = 0; c < report.plain.size(); c++) {
    const auto& [estimator, rmse] = report.plain[c];
    std::string settings = "breaks down along";
    for (const auto& axis : report.axes) {
      const StabilityCurve& curve = axis.curves[c];
      if (!curve.breaks.empty()) settings += fmt::format(" {} at {};", axis.name, breaks_text(axis, curve));
      for (std::size_t i = 0; i < axis.points.size(); i++)
        rows.push_back({{"frame", fmt::format("{} {:g} {}", axis.name, axis.points[i].at, axis.unit)},
                        {"candidate", estimator},
                        {"rmse", number(curve.rmse[i])},
                        {"warnings", axis.points[i].notes.size()},
                        {"fails", std::ranges::find(curve.breaks, i) != curve.breaks.end()}});
    }
    candidates.push_back({{"name", estimator}, {"settings", settings}, {"rmse", number(rmse)}});
  }
  return report_page(json_text({{"title", "stability"},
                                {"kind", "bench"},
                                {"device", report.device},
                                {"yardstick_ms", nullptr},
                                {"candidates", candidates},
                                {"rows", rows},
                                {"images", Json::array()}},
                               1));
}

}  // namespace alcove
