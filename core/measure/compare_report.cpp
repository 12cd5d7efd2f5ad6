// Writes a comparison as JSON and as a page, and checks it against limits.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "core/base/text.h"
#include "core/measure/compare.h"
#include "core/measure/report.h"

namespace alcove {
namespace {

using Json = nlohmann::ordered_json;

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

const Measure& measure_of(const char* name) {
  return *std::ranges::find_if(kMeasures, [&](const auto& m) { return std::string_view(m.name) == name; });
}

/// How bad a value is; one that could not be measured is the worst.
double badness_of(const Measure& measure, double value) {
  return std::isnan(value) ? std::numeric_limits<double>::infinity() : measure.badness(value);
}

/// The frame with the worst value of a measure.
const FrameComparison& worst_in(const CompareReport& report, const Measure& measure) {
  return *std::ranges::max_element(report.frames, {},
                                   [&](const auto& frame) { return badness_of(measure, measure.of(frame)); });
}

Json part_json(const PartErrors& part) { return {{"count", part.count}, {"rmse", part.rmse}, {"bias", part.bias}}; }

Json sky_json(const FrameComparison& frame) {
  if (!frame.sky_differs) return nullptr;
  const SkyDifference& sky = *frame.sky_differs;
  return {{"count", sky.count},
          {"zero_in", sky.zero_in_result ? "result" : "reference"},
          {"rmse_without", sky.rmse_without}};
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

/// Adds the measures; a value that is not finite becomes null where the JSON is written.
template <class Value>
void add_measures(Json& json, const Value& value) {
  for (const auto& measure : kMeasures) json[measure.name] = value(measure);
}

void add_counts(Json& json, const FrameComparison& frame) {
  json.update({{"count", frame.count}, {"excluded", frame.excluded}, {"masked", frame.masked}, {"holes", frame.holes}});
}

/// Counts, measures, bands, sky, edges and window of a frame.
void add_all(Json& json, const FrameComparison& frame) {
  add_counts(json, frame);
  add_measures(json, [&](const Measure& measure) { return measure.of(frame); });
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

/// A frame's number, or in a list its name.
Json id_of(const FrameComparison& frame, const CompareReport& report) {
  return report.is_list ? Json(frame.name) : Json(frame.frame);
}

Json frame_json(const FrameComparison& frame, const CompareReport& report) {
  Json json = {{"frame", id_of(frame, report)}, {"result", frame.result}, {"reference", frame.reference}};
  add_all(json, frame);
  return json;
}

/// A sequence's own numbers: each is the worst of all frames, the counts are sums.
void add_worst_measures(Json& json, const CompareReport& report) {
  FrameComparison all;
  for (const auto& frame : report.frames)
    for (const auto count :
         {&FrameComparison::count, &FrameComparison::excluded, &FrameComparison::masked, &FrameComparison::holes})
      all.*count += frame.*count;
  add_counts(json, all);
  add_measures(json, [&](const Measure& measure) { return measure.of(worst_in(report, measure)); });
}

Json mean_json(const CompareReport& report) {
  Json json;
  add_measures(json, [&](const Measure& measure) {
    double sum = 0;
    for (const auto& frame : report.frames) sum += measure.of(frame);
    return sum / double(report.frames.size());
  });
  return json;
}

/// The names of both files without their folders; with them if the names are equal. Of a list, the names of the results
/// are only a place for those of the frames.
std::pair<std::string, std::string> names_of(const CompareReport& report) {
  const auto file = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
  const std::size_t count = report.frames.size() + report.failed.size();
  if (report.is_list) return {counted(count, "frame"), file(report.reference)};
  if (file(report.result) == file(report.reference)) return {report.result, report.reference};
  return {file(report.result), file(report.reference)};
}

Json limits_json(const std::vector<CheckedLimit>& limits) {
  Json list = Json::array();
  for (const auto& limit : limits)
    list.push_back({{"option", limit.option},
                    {"limit", limit.limit},
                    {"value", limit.value},
                    {"frame", limit.frame},
                    {"holds", limit.broken.empty()}});
  return list;
}

Json failed_json(const CompareReport& report) {
  Json list = Json::array();
  for (const auto& failed : report.failed) list.push_back({{"frame", failed.name}, {"error", failed.error}});
  return list;
}

double share_of_holes(const FrameComparison& frame) {
  return double(frame.holes) / double(frame.count + frame.excluded);
}

std::string place_of(const FrameComparison& frame, bool is_one_of_many) {
  return is_one_of_many ? fmt::format("frame {}: ", frame.name) : "";
}

/// The holes of a frame that has more than the share; "" if it has not.
std::string holes_in(const FrameComparison& frame, double most, bool is_one_of_many) {
  if (share_of_holes(frame) <= most) return "";
  const HoleAt& hole = *frame.first_hole;
  return fmt::format(
      "{}{} of {} pixels are NaN or infinite in one file only, the first in the {} at x {}, y {}, channel {}",
      place_of(frame, is_one_of_many), frame.holes, frame.count + frame.excluded, file_of(hole), hole.x, hole.y,
      hole.channel);
}

CheckedLimit checked_holes(const FrameComparison& frame, bool is_one_of_many) {
  const double most = frame.limits.max_excluded.value_or(0);
  const std::string holes = holes_in(frame, most, is_one_of_many);
  return {"--max-excluded", most, share_of_holes(frame), frame.name,
          holes.empty() ? "" : fmt::format("{}, and --max-excluded is {:.6g}", holes, most)};
}

/// The limit of a frame that has it.
CheckedLimit checked(const FrameComparison& frame, const LimitRow& option, bool is_one_of_many) {
  const Measure& measure = measure_of(option.measure);
  const double limit = *(frame.limits.*option.value), value = measure.of(frame);
  CheckedLimit check{option.option, limit, value, frame.name, ""};
  if (measure.badness(value) <= measure.badness(limit)) return check;
  const std::string what = std::isnan(value)
                               ? fmt::format("cannot be measured in {}: {}", frame.result, measure.why_not)
                               : fmt::format("is {:.6g}", value);
  check.broken = fmt::format("{}{} {}, and {} is {:.6g}", place_of(frame, is_one_of_many), option.measure, what,
                             option.option, limit);
  if (std::isnan(value)) check.kind = measure.kind_without;
  return check;
}

/// Checks each limit where it is broken most, or else nearest to it.
std::vector<CheckedLimit> checked_limits(std::span<const FrameComparison> frames, bool is_many) {
  std::vector<CheckedLimit> checks;
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  const auto excess = [](const FrameComparison& frame) {
    const double share = share_of_holes(frame);
    return share > 0 || frame.limits.max_excluded ? share - frame.limits.max_excluded.value_or(0) : kNone;
  };
  const FrameComparison& holes = *std::ranges::max_element(frames, {}, excess);
  if (excess(holes) > kNone) checks.push_back(checked_holes(holes, is_many));
  for (const auto& option : kLimitTable) {
    if (option.value == &CompareLimits::max_excluded) continue;
    const Measure& measure = measure_of(option.measure);
    const auto badness = [&](const FrameComparison& frame) {
      const auto limit = frame.limits.*option.value;
      return limit ? badness_of(measure, measure.of(frame)) - measure.badness(*limit) : kNone;
    };
    const FrameComparison& worst = *std::ranges::max_element(frames, {}, badness);
    if (worst.limits.*option.value) checks.push_back(checked(worst, option, is_many));
  }
  return checks;
}

}  // namespace

std::string holes_beyond(const CompareReport& report, double most) {
  return holes_in(*std::ranges::max_element(report.frames, {}, share_of_holes), most, report.has_several());
}

bool has_limits(const CompareReport& report) {
  return std::ranges::any_of(report.frames, [](const auto& frame) { return frame.limits != CompareLimits{}; });
}

CompareLimits with_limits(CompareLimits limits, const CompareLimits& more) {
  for (const auto& row : kLimitTable)
    if (more.*row.value) limits.*row.value = more.*row.value;
  return limits;
}

std::vector<std::string> errors_in(const CompareReport& report) {
  std::vector<std::string> errors;
  for (const auto& failed : report.failed)
    if (std::ranges::find(errors, failed.error) == errors.end()) errors.push_back(failed.error);
  return errors;
}

bool fails(const FrameComparison& frame, const CompareReport& report) { return has_limits(report) && is_broken(frame); }

std::vector<CheckedLimit> checked_limits(const CompareReport& report) {
  return checked_limits(report.frames, report.has_several());
}

bool is_broken(const FrameComparison& frame) { return !broken_limits(checked_limits({&frame, 1}, false)).empty(); }

std::vector<std::string> broken_limits(const std::vector<CheckedLimit>& limits) {
  std::vector<std::string> sentences;
  for (const auto& limit : limits)
    if (!limit.broken.empty()) sentences.push_back(limit.broken);
  return sentences;
}

std::string compare_json(const CompareReport& report, const std::vector<CheckedLimit>& limits) {
  const bool has_frames = !report.frames.empty();
  Json json = {{"result", report.result}, {"reference", report.reference}, {"channels", Json::array()}};
  if (has_frames) json["channels"] = report.frames[0].channels;
  if (has_frames && report.has_several()) {
    add_worst_measures(json, report);
    const auto& worst = worst_frame(report);
    json["worst"] = {{"frame", id_of(worst, report)}, {"rmse", worst.errors.rmse}};
    json["mean"] = mean_json(report);
    if (report.is_sequence) json["flicker"] = report.flicker.value_or(NAN);
  } else if (has_frames) {
    add_all(json, report.frames[0]);
  }
  const auto broken = broken_limits(limits);
  json["pass"] = broken.empty() && report.failed.empty();
  json["broken"] = broken;
  json["failed"] = failed_json(report);
  json["limits"] = limits_json(limits);
  if (report.has_several())
    for (const auto& frame : report.frames) json["frames"].push_back(frame_json(frame, report));
  return json_text(json, 1);
}

namespace {

Json row_json(const FrameComparison& frame, const CompareReport& report, const std::string& candidate) {
  Json row = {{"frame", frame.name}, {"candidate", candidate}, {"fails", fails(frame, report)}};
  if (frame.holes) row["holes"] = frame.holes;
  add_measures(row, [&](const Measure& measure) { return measure.of(frame); });
  return row;
}

Json image_json(const FrameComparison& frame, const std::string& candidate) {
  return {{"frame", frame.name},
          {"candidate", candidate},
          {"width", frame.width},
          {"height", frame.height},
          {"result", frame.pictures->result},
          {"truth", frame.pictures->reference},
          {"error", url_of_png(frame.error_png)},
          {"full", frame.error_scale}};
}

Json sequence_json(const CompareReport& report) {
  if (!report.has_several()) return nullptr;
  const FrameComparison& worst = worst_frame(report);
  Json json = {
      {"worst_frame", worst.name}, {"worst_rmse", worst.errors.rmse}, {"mean_rmse", mean_json(report)["rmse"]}};
  if (report.is_sequence) json["flicker"] = report.flicker.value_or(NAN);
  return json;
}

Json verdict_json(const CompareReport& report, const std::vector<CheckedLimit>& limits) {
  if (limits.empty() && report.failed.empty()) return nullptr;
  return {{"pass", broken_limits(limits).empty() && report.failed.empty()},
          {"limits", limits_json(limits)},
          {"failed", failed_json(report)}};
}

}  // namespace

std::string compare_page(const CompareReport& report, const std::vector<CheckedLimit>& limits) {
  const auto [name, reference] = names_of(report);
  Json candidate = {{"name", name}, {"settings", "against " + report.reference}};
  candidate.update(mean_json(report));
  Json rows = Json::array(), images = Json::array();
  for (const auto& frame : report.frames) {
    rows.push_back(row_json(frame, report, name));
    if (frame.pictures) images.push_back(image_json(frame, name));
  }
  return report_page(json_text({{"title", name + " against " + reference},
                                {"kind", "compare"},
                                {"device", nullptr},
                                {"yardstick_ms", nullptr},
                                {"verdict", verdict_json(report, limits)},
                                {"candidates", Json::array({candidate})},
                                {"rows", rows},
                                {"sequence", sequence_json(report)},
                                {"images", images}},
                               1));
}

// JUnit.

namespace {

/// Text within XML, which has no control characters, and neither U+FFFE nor U+FFFF.
std::string xml_text(const std::string& text) {
  std::string valid = printable(text);
  for (const char* none : {"\xef\xbf\xbe", "\xef\xbf\xbf"})
    for (std::size_t at = 0; (at = valid.find(none, at)) != valid.npos;) valid.replace(at, 3, "\xef\xbf\xbd");
  return markup_text(valid);
}

std::string case_text(const std::string& name, const std::string& inside) {
  return fmt::format("  <testcase classname=\"alcove compare\" name=\"{}\">{}</testcase>\n", xml_text(name),
                     inside.empty() ? "" : "\n" + inside + "  ");
}

/// Why a frame fails, and the picture of its error.
std::string failure_text(const FrameComparison& frame, const std::string& file) {
  return fmt::format(
      "    <failure message=\"{}\"/>\n    <system-out>[[ATTACHMENT|{}]] red where the result is larger than the "
      "reference, "
      "blue where it is smaller, in full colour from an error of {:.3g}</system-out>\n",
      xml_text(fmt::format("{}", fmt::join(broken_limits(checked_limits({&frame, 1}, false)), "; "))),
      xml_text(failure_path(file, frame.name)), frame.error_scale);
}

}  // namespace

std::string failure_path(const std::string& junit, const std::string& frame) {
  std::string name = frame;
  std::ranges::replace_if(
      name, [](unsigned char c) { return !std::isalnum(c) && c != '-' && c != '_'; }, '_');
  return std::filesystem::path(junit).replace_extension("").string() + "." + name + ".error.png";
}

std::string compare_junit(const CompareReport& report, const std::string& file) {
  std::string cases;
  int failures = 0;
  for (const auto& frame : report.frames) {
    const bool is_failure = fails(frame, report);
    failures += is_failure;
    cases += case_text(frame.name, is_failure ? failure_text(frame, file) : "");
  }
  for (const auto& failed : report.failed)
    cases += case_text(failed.name, fmt::format("    <error message=\"{}\"/>\n", xml_text(failed.error)));
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuite name=\"{} against {}\" tests=\"{}\" failures=\"{}\" errors=\"{}\">\n{}</testsuite>\n",
      xml_text(report.result), xml_text(report.reference), report.frames.size() + report.failed.size(), failures,
      report.failed.size(), cases);
}

}  // namespace alcove
