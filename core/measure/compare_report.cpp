// Writes a comparison as JSON and as a page, and checks it against limits.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/measure/compare.h"
#include "core/measure/report.h"

namespace alcove {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinity and no NaN.
Json number(std::optional<double> value) { return value && std::isfinite(*value) ? Json(*value) : Json(nullptr); }

/// A measure of a frame; NaN if it could not be measured.
struct Measure {
  const char* name;
  double (*of)(const FrameComparison&);
  double (*badness)(double);                       // larger is worse
  const char* why_not = "";                        // the reason if it could not be measured
  ErrorKind kind_without = ErrorKind::comparison;  // the error if a limit cannot be checked
};

double as_it_is(double x) { return x; }
double negative(double x) { return -x; }
double size(double x) { return std::abs(x); }

constexpr std::array kMeasures = {
    Measure{"rmse", [](const FrameComparison& f) { return f.errors.rmse; }, as_it_is},
    Measure{"mae", [](const FrameComparison& f) { return f.errors.mae; }, as_it_is},
    Measure{"bias", [](const FrameComparison& f) { return f.errors.bias; }, size},
    Measure{"max", [](const FrameComparison& f) { return f.errors.max; }, as_it_is},
    Measure{"p95", [](const FrameComparison& f) { return f.errors.p95; }, as_it_is},
    Measure{"p99", [](const FrameComparison& f) { return f.errors.p99; }, as_it_is},
    Measure{"psnr", [](const FrameComparison& f) { return f.psnr; }, negative},
    Measure{"ssim", [](const FrameComparison& f) { return f.ssim.value_or(NAN); }, negative,
            "no compared pixel is 5 pixels from all borders"},
    Measure{"flip", [](const FrameComparison& f) { return f.flip; }, as_it_is},
    Measure{"grain", [](const FrameComparison& f) { return f.grain.value_or(NAN); }, as_it_is,
            "--depth shows no 15 x 15 compared pixels of one plane", ErrorKind::input},
};

/// The frame with the worst value of a measure; a value that could not be measured is the worst.
const FrameComparison& worst_in(const CompareReport& report, const Measure& measure) {
  return *std::ranges::max_element(report.frames, {}, [&](const auto& frame) {
    const double value = measure.of(frame);
    return std::isnan(value) ? std::numeric_limits<double>::infinity() : measure.badness(value);
  });
}

Json part_json(const PartErrors& part) { return {{"count", part.count}, {"rmse", part.rmse}, {"bias", part.bias}}; }

Json sky_json(const FrameComparison& frame) {
  if (!frame.sky_differs) return nullptr;
  const SkyDifference& sky = *frame.sky_differs;
  return {{"count", sky.count},
          {"zero_in", sky.zero_in_result ? "result" : "reference"},
          {"rmse_without", number(sky.rmse_without)}};
}

const char* file_of(const HoleAt& hole) { return hole.in_result ? "result" : "reference"; }

Json hole_json(const std::optional<HoleAt>& hole) {
  if (!hole) return nullptr;
  return {{"x", hole->x}, {"y", hole->y}, {"channel", hole->channel}, {"in", file_of(*hole)}};
}

Json window_json(const std::optional<Window>& window) {
  if (!window) return nullptr;
  return {{"x", window->x}, {"y", window->y}, {"width", window->width}, {"height", window->height}};
}

/// Bands, sky, edges and window of a frame.
void add_parts(Json& json, const FrameComparison& frame) {
  Json bands = Json::array();
  for (const auto& band : frame.bands) {
    Json entry = {{"from", band.from}, {"to", band.to}};
    entry.update(part_json(band.errors));
    bands.push_back(std::move(entry));
  }
  json["bands"] = std::move(bands);
  json["sky_differs"] = sky_json(frame);
  json["first_hole"] = hole_json(frame.first_hole);
  json["edges"] =
      frame.edges ? Json{{"at", part_json(frame.edges->at)}, {"away", part_json(frame.edges->away)}} : Json(nullptr);
  json["common_window"] = window_json(frame.common);
}

void add_measures(Json& json, const FrameComparison& frame) {
  json.update({{"count", frame.count}, {"excluded", frame.excluded}, {"masked", frame.masked}, {"holes", frame.holes}});
  for (const auto& measure : kMeasures) json[measure.name] = number(measure.of(frame));
}

Json frame_json(const FrameComparison& frame) {
  Json json = {{"frame", frame.frame}, {"result", frame.result}, {"reference", frame.reference}};
  add_measures(json, frame);
  add_parts(json, frame);
  return json;
}

/// A sequence's own numbers: each is the worst of all frames, the counts are sums.
void add_worst_measures(Json& json, const CompareReport& report) {
  std::size_t count = 0, excluded = 0, masked = 0, holes = 0;
  for (const auto& frame : report.frames) {
    count += frame.count;
    excluded += frame.excluded;
    masked += frame.masked;
    holes += frame.holes;
  }
  json.update({{"count", count}, {"excluded", excluded}, {"masked", masked}, {"holes", holes}});
  for (const auto& measure : kMeasures) json[measure.name] = number(measure.of(worst_in(report, measure)));
}

Json mean_json(const CompareReport& report) {
  Json json;
  for (const auto& measure : kMeasures) {
    double sum = 0;
    for (const auto& frame : report.frames) sum += measure.of(frame);
    json[measure.name] = number(sum / double(report.frames.size()));
  }
  return json;
}

/// The names of both files without their folders; with them if the names are equal.
std::pair<std::string, std::string> names_of(const CompareReport& report) {
  const auto file = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
  if (file(report.result) == file(report.reference)) return {report.result, report.reference};
  return {file(report.result), file(report.reference)};
}

double share_of_holes(const FrameComparison& frame) {
  return double(frame.holes) / double(frame.count + frame.excluded);
}

struct Limit {
  const char* measure;
  const char* option;
  std::optional<double> value;
};

}  // namespace

std::string holes_beyond(const CompareReport& report, double most) {
  const FrameComparison& frame = *std::ranges::max_element(report.frames, {}, share_of_holes);
  if (share_of_holes(frame) <= most) return "";
  const HoleAt& hole = *frame.first_hole;
  return fmt::format(
      "{}{} of {} pixels are NaN or infinite in one file only, the first in the {} at x {}, y {}, channel {}",
      report.is_sequence ? fmt::format("frame {}: ", frame.frame) : "", frame.holes, frame.count + frame.excluded,
      file_of(hole), hole.x, hole.y, hole.channel);
}

BrokenLimits broken_limits(const CompareReport& report, const CompareLimits& limits) {
  BrokenLimits broken;
  const double most_holes = limits.max_excluded.value_or(0);
  if (const std::string holes = holes_beyond(report, most_holes); !holes.empty())
    broken.sentences.push_back(fmt::format("{}, and --max-excluded is {:.6g}", holes, most_holes));
  const std::array all{Limit{"rmse", "--max-rmse", limits.max_rmse}, Limit{"p99", "--max-p99", limits.max_p99},
                       Limit{"ssim", "--min-ssim", limits.min_ssim}, Limit{"flip", "--max-flip", limits.max_flip},
                       Limit{"bias", "--max-bias", limits.max_bias}, Limit{"grain", "--max-grain", limits.max_grain}};
  for (const auto& limit : all) {
    if (!limit.value) continue;
    const Measure& measure =
        *std::ranges::find_if(kMeasures, [&](const auto& m) { return std::string_view(m.name) == limit.measure; });
    const FrameComparison& worst = worst_in(report, measure);
    const double value = measure.of(worst);
    if (measure.badness(value) <= measure.badness(*limit.value)) continue;
    const std::string where = report.is_sequence ? fmt::format("frame {}: ", worst.frame) : "";
    const std::string what = std::isnan(value)
                                 ? fmt::format("cannot be measured in {}: {}", worst.result, measure.why_not)
                                 : fmt::format("is {:.6g}", value);
    broken.sentences.push_back(
        fmt::format("{}{} {}, and {} is {:.6g}", where, limit.measure, what, limit.option, *limit.value));
    if (std::isnan(value) && measure.kind_without == ErrorKind::input) broken.kind = ErrorKind::input;
  }
  return broken;
}

std::string compare_json(const CompareReport& report, const std::vector<std::string>& broken) {
  Json json = {{"result", report.result}, {"reference", report.reference}, {"channels", report.frames[0].channels}};
  if (report.is_sequence) {
    add_worst_measures(json, report);
    const auto& worst = worst_frame(report);
    json["worst"] = {{"frame", worst.frame}, {"rmse", worst.errors.rmse}};
    json["mean"] = mean_json(report);
    json["flicker"] = number(report.flicker);
  } else {
    add_measures(json, report.frames[0]);
    add_parts(json, report.frames[0]);
  }
  json["pass"] = broken.empty();
  json["broken"] = broken;
  if (report.is_sequence)
    for (const auto& frame : report.frames) json["frames"].push_back(frame_json(frame));
  return json_text(json, 1);
}

std::string compare_page(const CompareReport& report) {
  const auto [name, reference] = names_of(report);
  Json candidate = {{"name", name}, {"settings", "against " + report.reference}, {"ms", nullptr}, {"ms_min", nullptr}};
  candidate.update(mean_json(report));
  Json rows = Json::array(), images = Json::array();
  for (const auto& frame : report.frames) {
    const std::string label =
        report.is_sequence ? std::to_string(frame.frame) : std::filesystem::path(frame.reference).filename().string();
    Json row = {{"frame", label},
                {"candidate", name},
                {"ms", nullptr},
                {"ms_min", nullptr},
                {"estimator_rmse", nullptr},
                {"geometry_rmse", nullptr},
                {"samples_per_pixel", nullptr}};
    for (const auto& measure : kMeasures) row[measure.name] = number(measure.of(frame));
    rows.push_back(std::move(row));
    if (frame.pictures)
      images.push_back({{"frame", label},
                        {"candidate", name},
                        {"width", frame.width},
                        {"height", frame.height},
                        {"result", frame.pictures->result},
                        {"truth", frame.pictures->reference},
                        {"error", frame.pictures->error}});
  }
  const FrameComparison& worst = worst_frame(report);
  const Json sequence = {{"worst_frame", std::to_string(worst.frame)},
                         {"worst_rmse", number(worst.errors.rmse)},
                         {"mean_rmse", mean_json(report)["rmse"]},
                         {"flicker", number(report.flicker)}};
  const std::string title = name + " against " + reference;
  return report_page(json_text({{"title", title},
                                {"kind", "compare"},
                                {"device", nullptr},
                                {"yardstick_ms", nullptr},
                                {"candidates", Json::array({candidate})},
                                {"rows", rows},
                                {"sequence", report.is_sequence ? sequence : Json(nullptr)},
                                {"images", images}},
                               1));
}

}  // namespace alcove
