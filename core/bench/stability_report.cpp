// The stability report as text, JSON and a page with a drawing for each axis.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/bench/stability.h"

namespace alcove {
namespace {

using Json = nlohmann::ordered_json;

/// The text as HTML shows it.
std::string escaped(const std::string& text) { return markup_text(as_utf8(text)); }

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

constexpr std::array kColors{"#2f6fb0", "#d1495b", "#e3963e", "#2a9d6f", "#7b5ea7", "#8a6a4f", "#4aa3b5"};
constexpr double kWidth = 520, kHeight = 210;                       // of a drawing, px
constexpr double kLeft = 46, kRight = 26, kTop = 10, kBottom = 34;  // margins, px
constexpr double kMost = 0.4;                                       // the largest RMSE that is drawn as it is
constexpr std::array kLevels{0.0, 0.01, 0.05, 0.1, 0.2, 0.4};       // RMSE of the grid's lines
constexpr double kLabelWidth = 40;                                  // px between labels of the axis

const char* color_of(std::size_t curve) { return kColors[curve % kColors.size()]; }

/// The curves of one axis as SVG, and the table below them.
struct Drawing {
  const StabilityAxis& axis;

  double x(std::size_t i) const {
    const auto place = [&](std::size_t k) {
      return axis.logarithmic ? std::log10(axis.points[k].at) : axis.points[k].at;
    };
    const double least = place(0), most = place(axis.points.size() - 1);
    return kLeft + (place(i) - least) / (most - least) * (kWidth - kLeft - kRight);
  }
  static double y(double rmse) {
    return kTop + (1 - std::sqrt(std::min(rmse, kMost) / kMost)) * (kHeight - kTop - kBottom);
  }

  static std::string grid() {
    std::string out;
    for (const double level : kLevels)
      out += fmt::format(
          "<line class=\"grid\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/><text x=\"{3}\" y=\"{4:.1f}\" "
          "text-anchor=\"end\">{5:g}</text>",
          kLeft, kWidth - kRight, y(level), kLeft - 5, y(level) + 4, level);
    return out;
  }

  /// Labels of the axis, and a band wherever a run says that its result is unsound.
  std::string points() const {
    std::string out;
    double last = -100;
    for (std::size_t i = 0; i < axis.points.size(); i++) {
      const StabilityPoint& point = axis.points[i];
      if (!point.notes.empty())
        out += fmt::format(
            "<rect class=\"said\" x=\"{:.1f}\" y=\"{}\" width=\"8\" height=\"{}\"><title>{}</title></rect>", x(i) - 4,
            kTop, kHeight - kTop - kBottom, escaped(fmt::format("{}", fmt::join(texts_of(point.notes), "; "))));
      if (x(i) - last < kLabelWidth) continue;
      last = x(i);
      out +=
          fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:g}</text>", x(i), kHeight - 20, point.at);
    }
    return out;
  }

  /// One estimator's line, with a dot where it breaks down.
  std::string curve(std::size_t c) const {
    const StabilityCurve& curve = axis.curves[c];
    std::string points;
    for (std::size_t i = 0; i < curve.rmse.size(); i++) points += fmt::format("{:.1f},{:.1f} ", x(i), y(curve.rmse[i]));
    std::string out = fmt::format("<polyline points=\"{}\" stroke=\"{}\"><title>{}</title></polyline>", points,
                                  color_of(c), escaped(curve.estimator));
    for (const std::size_t i : curve.breaks)
      out += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\"><title>{} breaks down at {:g}, RMSE "
          "{:.3f}</title></circle>",
          x(i), y(curve.rmse[i]), color_of(c), escaped(curve.estimator), axis.points[i].at, curve.rmse[i]);
    return out;
  }

  std::string svg() const {
    std::string out = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"RMSE against {}\">", kWidth,
                                  kHeight, escaped(axis.name));
    out += grid() + points();
    out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", kWidth - kRight, kHeight - 4,
                       escaped(axis.unit));
    for (std::size_t c = 0; c < axis.curves.size(); c++) out += curve(c);
    return out + "</svg>";
  }

  std::string row(const StabilityCurve& curve) const {
    if (curve.breaks.empty())
      return fmt::format("<tr><td>{}</td><td>{:.4f}</td><td>&ndash;</td><td>&ndash;</td></tr>",
                         escaped(curve.estimator), worst_of(curve));
    return fmt::format("<tr><td>{}</td><td>{:.4f}</td><td>{}</td><td{}>{}</td></tr>", escaped(curve.estimator),
                       worst_of(curve), places_of(axis, curve), curve.said ? "" : " class=\"silent\"",
                       curve.said ? "yes" : "no");
  }

  std::string table() const {
    std::string out =
        "<table><tr><th>estimator</th><th>worst RMSE</th><th>breaks down at</th><th>a run says so</th></tr>";
    for (const auto& curve : axis.curves) out += row(curve);
    return out + "</table>";
  }
};

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width, initial-scale=1"><title>Alcove stability</title>
<style>
:root { color-scheme: light dark; --line: #8884; --said: #f0b42933; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 76rem; padding: 0 1rem; }
h2 { font-size: 1.05rem; margin: 0 0 .4rem; }
main { display: grid; grid-template-columns: repeat(auto-fit, minmax(30rem, 1fr)); gap: 1.6rem; }
section { border: 1px solid var(--line); border-radius: 8px; padding: .9rem 1rem; min-width: 0; }
svg { width: 100%; height: auto; } svg text { font-size: 11px; fill: currentColor; }
polyline { fill: none; stroke-width: 1.8; } .grid { stroke: var(--line); } .said { fill: var(--said); }
table { border-collapse: collapse; width: 100%; font-size: .85rem; margin-top: .5rem; }
th, td { text-align: left; padding: .12rem .5rem .12rem 0; border-bottom: 1px solid var(--line); }
.silent { color: #c33; font-weight: 600; } .key i { display: inline-block; width: 1.1em; height: .25em; vertical-align: middle; margin: 0 .3em 0 .9em; }
</style></head><body>
)";

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
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
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
  std::string page = kHead;
  page += fmt::format(
      "<h1>Alcove stability</h1><p>{}. RMSE of each estimator against the reference in double precision, in a room of "
      "48 x 36 pixels. A dot is where it breaks down: "
      "{:g} above its error in the plain room. Bands are where <code>alcove run</code> says so (point at them).</p><p "
      "class=\"key\">",
      escaped(report.device), kBreakdown);
  for (std::size_t c = 0; c < report.plain.size(); c++)
    page += fmt::format("<i style=\"background:{}\"></i>{} {:.3f}", color_of(c), escaped(report.plain[c].first),
                        report.plain[c].second);
  page += "</p><main>\n";
  for (const auto& axis : report.axes)
    page += fmt::format("<section><h2>{}</h2>{}{}</section>\n", escaped(axis.name), Drawing{axis}.svg(),
                        Drawing{axis}.table());
  return page + "</main></body></html>\n";
}

}  // namespace alcove
