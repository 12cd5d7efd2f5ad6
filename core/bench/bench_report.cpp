// Writes a benchmark as JSON, as CSV and as a page, and checks it against limits.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/bench/bench.h"
#include "core/measure/report.h"

namespace alcove {
namespace {

using Json = nlohmann::ordered_json;

Json number(std::optional<double> value) { return value && std::isfinite(*value) ? Json(*value) : Json(nullptr); }

Json to_json(const BenchRow& row) {
  Json passes = Json::array();
  for (const auto& pass : row.passes)
    passes.push_back({{"name", pass.name},
                      {"ms", pass.ms},
                      {"ms_min", pass.ms_min},
                      {"bytes_read", pass.bytes_read},
                      {"bytes_written", pass.bytes_written}});
  return {{"frame", row.frame},
          {"candidate", row.candidate},
          {"ms", row.ms},
          {"ms_min", row.ms_min},
          {"ms_max", row.ms_max},
          {"samples_per_pixel", row.samples_per_pixel},
          {"rmse", row.rmse},
          {"mae", row.mae},
          {"bias", row.bias},
          {"p99", row.p99},
          {"grain", number(row.grain)},
          {"mottle", number(row.mottle)},
          {"estimator_rmse", number(row.estimator_rmse)},
          {"geometry_rmse", number(row.geometry_rmse)},
          {"passes", passes}};
}

/// The mean over the frames that have the measure.
std::optional<double> mean_of(const std::vector<const BenchRow*>& rows, std::optional<double> BenchRow::*measure) {
  double sum = 0;
  int count = 0;
  for (const auto* row : rows) {
    if (!(row->*measure)) continue;
    sum += *(row->*measure);
    count++;
  }
  return count ? std::optional(sum / count) : std::nullopt;
}

/// A candidate's means over the frames.
Json to_json(const BenchCandidate& candidate, const BenchReport& report) {
  Json json = {{"name", candidate.name}, {"settings", candidate.settings_text}};
  std::vector<const BenchRow*> rows;
  for (const auto& row : report.rows)
    if (row.candidate == candidate.name) rows.push_back(&row);
  const auto mean = [&](const char* key, auto member) {
    double sum = 0;
    for (const auto* row : rows) sum += row->*member;
    json[key] = sum / double(rows.size());
  };
  mean("ms", &BenchRow::ms);
  mean("ms_min", &BenchRow::ms_min);
  mean("samples_per_pixel", &BenchRow::samples_per_pixel);
  mean("rmse", &BenchRow::rmse);
  mean("mae", &BenchRow::mae);
  mean("bias", &BenchRow::bias);
  mean("p99", &BenchRow::p99);
  json["grain"] = number(mean_of(rows, &BenchRow::grain));
  json["mottle"] = number(mean_of(rows, &BenchRow::mottle));
  return json;
}

Json to_json(const BenchReport& report) {
  Json frames = Json::array(), candidates = Json::array(), rows = Json::array();
  for (const auto& frame : report.frames)
    frames.push_back({{"name", frame.name},
                      {"width", frame.width},
                      {"height", frame.height},
                      {"yardstick_ms", number(frame.yardstick_ms)}});
  for (const auto& candidate : report.candidates) candidates.push_back(to_json(candidate, report));
  for (const auto& row : report.rows) rows.push_back(to_json(row));
  return {{"title", report.title}, {"device", report.device},  {"repeats", report.repeats},
          {"frames", frames},      {"candidates", candidates}, {"rows", rows}};
}

/// A CSV field: quoted where it must be.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

/// `lack` says what a frame without the measure does not show.
double measured(const BenchRow& row, const std::string& measure, std::optional<double> value, const char* lack) {
  if (!value)
    fail(ErrorKind::input, "{} on {}: {} has a limit and cannot be measured: the frame shows no {} (--limits)",
         row.candidate, row.frame, measure, lack);
  return *value;
}

double measured(const BenchRow& row, const std::string& measure) {
  if (measure == "rmse") return row.rmse;
  if (measure == "mae") return row.mae;
  if (measure == "p99") return row.p99;
  if (measure == "bias") return std::abs(row.bias);
  if (measure == "grain") return measured(row, measure, row.grain, "15 x 15 pixels of one plane");
  if (measure == "mottle") return measured(row, measure, row.mottle, "smooth surface in half shadow");
  return row.estimator_rmse.value();  // require_known() has seen to it
}

}  // namespace

std::string bench_json(const BenchReport& report) { return json_text(to_json(report), 1) + "\n"; }

std::string bench_csv(const BenchReport& report) {
  std::string text =
      "frame,candidate,ms,ms_min,ms_max,yardsticks,samples_per_pixel,rmse,mae,bias,p99,estimator_rmse,geometry_rmse,"
      "bytes_read,bytes_written,grain,mottle\n";
  const auto optional = [](std::optional<double> value) { return value ? fmt::format("{}", *value) : ""; };
  for (const auto& row : report.rows) {
    const auto& frame = *std::ranges::find(report.frames, row.frame, &BenchFrame::name);
    std::uint64_t read = 0, written = 0;
    for (const auto& pass : row.passes) {
      read += pass.bytes_read;
      written += pass.bytes_written;
    }
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", field(row.frame), field(row.candidate),
                        row.ms, row.ms_min, row.ms_max,
                        frame.yardstick_ms ? fmt::format("{}", row.ms / *frame.yardstick_ms) : "",
                        row.samples_per_pixel, row.rmse, row.mae, row.bias, row.p99, optional(row.estimator_rmse),
                        optional(row.geometry_rmse), read, written, optional(row.grain), optional(row.mottle));
  }
  return text;
}

std::string bench_page(const BenchReport& report) {
  Json page = to_json(report);
  page["kind"] = "bench";
  double yardsticks = 0;
  for (const auto& frame : report.frames) yardsticks += frame.yardstick_ms.value_or(NAN) / double(report.frames.size());
  page["yardstick_ms"] = number(yardsticks);
  for (auto& row : page["rows"]) row.erase("passes");
  Json images = Json::array();
  for (const auto& row : report.rows) {
    const auto& frame = *std::ranges::find(report.frames, row.frame, &BenchFrame::name);
    const bool first = row.candidate == report.candidates.front().name;
    images.push_back({{"frame", row.frame},
                      {"candidate", row.candidate},
                      {"width", frame.width},
                      {"height", frame.height},
                      {"result", grey_picture(frame.width, frame.height, row.ao)},
                      {"truth", first ? Json(grey_picture(frame.width, frame.height, frame.truth)) : Json(nullptr)},
                      {"error", error_picture(frame.width, frame.height, row.ao, frame.truth)}});
  }
  page["images"] = std::move(images);
  return report_page(json_text(page, 1));
}

std::vector<std::string> broken_limits(const BenchReport& report, const std::vector<Limit>& limits) {
  std::vector<std::string> broken;
  for (const auto& limit : limits) {
    const auto row = std::ranges::find_if(
        report.rows, [&](const auto& r) { return r.frame == limit.frame && r.candidate == limit.candidate; });
    const double value = measured(*row, limit.measure);
    if (!(value <= limit.most))
      broken.push_back(fmt::format("{} on {}: {} is {:.4f}, and may be {:.4f}", limit.candidate, limit.frame,
                                   limit.measure, value, limit.most));
  }
  return broken;
}

}  // namespace alcove
