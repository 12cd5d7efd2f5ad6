// Suites from TOML; interleaved timing, errors and their two parts; the report as JSON, as CSV and as a page.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/bench.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "core/base/frame_list.h"
#include "core/base/ranks.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "core/chain/estimate/estimate.h"
#include "core/formats/exr.h"
#include "core/frame/find/frame_source.h"
#include "core/frame/pixels/statistics.h"
#include "core/gpu/recorder.h"
#include "core/measure/report.h"

namespace alcove {

// Suites.

namespace {

namespace fs = std::filesystem;

/// A TOML value as an option's argument.
std::string argument_of(const TomlTable& table, std::string_view key, const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return *text;
  if (const auto number = node.value_exact<std::int64_t>()) return fmt::format("{}", *number);
  if (const auto number = node.value_exact<double>()) return fmt::format("{}", *number);
  if (const auto flag = node.value_exact<bool>(); flag && *flag) return "true";
  table.refuse(key, "must be a string, a number or true");
}

SuiteFrame frame_of(const ListedFrame& listed, const std::string& path) {
  const auto require = [&](bool is_there, const char* key) {
    if (!is_there) fail(ErrorKind::input, "{}: frame {} has no \"{}\"", path, listed.name, key);
  };
  require(!listed.camera.empty(), "camera");
  require(listed.radius.has_value(), "radius");
  require(!listed.truth.empty(), "truth");
  // Suites of before lists were those of compare, too, have it as "reference".
  const bool is_old = listed.cpu_reference.empty() && listed.reference.size() == 1;
  const std::string& kept = is_old ? listed.reference.front() : listed.cpu_reference;
  return {listed.name, listed.input, listed.camera, *listed.radius, listed.truth, kept};
}

/// A setting as alcove run takes it.
std::string argument(const std::string& key, const std::string& value) {
  return key == "preset" ? "--preset=" + value : fmt::format("--set={}={}", key, value);
}

SuiteCandidate candidate_of(const TomlTable& table) {
  SuiteCandidate candidate{table.text("name"), {}};
  for (const auto& [key, value] : table.values)
    if (key.str() != "name") {
      candidate.arguments.push_back(argument(std::string(key.str()), argument_of(table, key.str(), value)));
    }
  return candidate;
}

/// One candidate for every combination of the listed values, named by them.
std::vector<SuiteCandidate> candidates_of_sweep(const TomlTable& table) {
  std::vector<SuiteCandidate> candidates(1);
  for (const auto& [key, value] : table.values) {
    std::vector<std::string> choices;
    if (const auto* list = value.as_array())
      for (const auto& entry : *list) choices.push_back(argument_of(table, key.str(), entry));
    else
      choices.push_back(argument_of(table, key.str(), value));
    if (choices.empty()) table.refuse(key.str(), "must not be empty");
    std::vector<SuiteCandidate> longer;
    for (const auto& candidate : candidates)
      for (const auto& choice : choices) {
        longer.push_back(candidate);
        longer.back().name += fmt::format("{}{} {}", candidate.name.empty() ? "" : ", ", key.str(), choice);
        longer.back().arguments.push_back(argument(std::string(key.str()), choice));
      }
    candidates = std::move(longer);
  }
  return candidates;
}

}  // namespace

Suite read_suite(const std::string& path, const std::string& data) {
  const toml::table root = read_toml(path, "suite", "SUITE");
  const TomlTable top{path, "the suite", root};
  Suite suite;
  suite.title = top.text("title");
  suite.repeats = top.count("repeats", suite.repeats, 1);
  suite.reference_slices = top.count("reference-slices", suite.reference_slices, 0);
  for (const auto& frame : frames_in(root, path, data.empty() ? fs::path(path).parent_path().string() : data))
    suite.frames.push_back(frame_of(frame, path));
  for_each_table(path, root, "candidate",
                 [&](const TomlTable& table) { suite.candidates.push_back(candidate_of(table)); });
  for_each_table(path, root, "sweep", [&](const TomlTable& table) {
    for (auto& candidate : candidates_of_sweep(table)) suite.candidates.push_back(std::move(candidate));
  });
  require_unique_names(path, suite.candidates, "candidate");
  return suite;
}

std::vector<Limit> read_limits(const std::string& path) {
  const toml::table root = read_toml(path, "limits", "--limits");
  TomlTable{path, "the limits", root}.require_keys({"limit"});
  std::vector<Limit> limits;
  for_each_table(path, root, "limit", [&](const TomlTable& table) {
    const std::set<std::string> measures = {"rmse", "mae", "p99", "bias", "grain", "mottle", "estimator-rmse"};
    auto known = measures;
    known.insert({"frame", "candidate"});
    table.require_keys(known);
    for (const auto& measure : measures)
      if (table.values.contains(measure))
        limits.push_back({table.text("frame"), table.text("candidate"), measure, table.positive(measure)});
  });
  if (limits.empty()) fail(ErrorKind::input, "{}: there is no [[limit]] with a measure (--limits)", path);
  return limits;
}

void require_known(const std::vector<Limit>& limits, const Suite& suite, const std::string& path) {
  std::vector<std::string> frames, candidates;
  std::ranges::transform(suite.frames, std::back_inserter(frames), &SuiteFrame::name);
  std::ranges::transform(suite.candidates, std::back_inserter(candidates), &SuiteCandidate::name);
  for (const auto& limit : limits) {
    if (limit.measure == "estimator-rmse" && suite.reference_slices == 0)
      fail(ErrorKind::usage, "{}: a limit for estimator-rmse needs --reference-slices above 0 (--limits)", path);
    for (const auto& [what, name, names] :
         {std::tuple("frame", &limit.frame, &frames), {"candidate", &limit.candidate, &candidates}})
      if (std::ranges::find(*names, *name) == names->end())
        fail(ErrorKind::input, "{}: the suite has no {} {}{} (--limits)", path, what, *name, suggestion(*name, *names));
  }
}

// References in EXR files: one channel, and the settings as an attribute.

namespace {

constexpr const char* kAttribute = "alcove/reference";

const char* name_of(ThicknessRule rule) {
  switch (rule) {
    case ThicknessRule::infinite: return "infinite";
    case ThicknessRule::constant: return "constant";
    case ThicknessRule::width: return "width";
  }
  return "";
}

}  // namespace

std::string text_of(const ReferenceSettings& settings) {
  return fmt::format(
      "radius {} falloff {} from {} slices {} thickness {} length {} share {} pixels {} complete {} bias {}",
      settings.radius, word_of(settings.falloff), settings.falloff_start, settings.slices, name_of(settings.thickness),
      settings.thickness_length, settings.width_share, settings.width_pixels, word_of(settings.complete),
      settings.bias);
}

std::vector<float> read_kept_reference(const std::string& path, const ReferenceSettings& settings, const Window& data) {
  Image image = read_exr_image(path);
  const auto made_with = attribute_of_whole_exr(path, kAttribute);
  if (!made_with || image.names.size() != 1)
    fail(ErrorKind::input, "{}: this is no reference: it needs one channel and the attribute {}", path, kAttribute);
  if (image.data != data)
    fail(ErrorKind::input, "{}: the reference is of {}, and its frame of {}", path, to_string(image.data),
         to_string(data));
  if (*made_with != text_of(settings)) return {};
  return std::move(image.pixels);
}

// Measuring.

namespace {

/// A suite's frame, loaded.
struct LoadedFrame {
  HostFrame host;
  std::vector<std::vector<float>> truths;
  std::vector<float> truth;           // their mean
  std::vector<std::uint8_t> surface;  // 1 where there is no sky: what is measured
  std::vector<float> planar;          // depth in scene units, infinite on sky
  std::vector<std::uint8_t> half;     // 1 in half shadow: where mottle is measured
};

/// In the file's own space, of unit length; empty: the frame has none.
std::vector<float> unit_normals(const HostFrame& host) {
  const std::size_t pixels = host.data.pixels();
  std::vector<float> unit(host.normal.empty() ? 0 : 3 * pixels);
  for (std::size_t i = 0; 3 * i < unit.size(); i++) {
    const Vector3 n = decoded_normal(host.normal, pixels, i, host.normal_encoding, host.normal_unorm);
    for (std::size_t c = 0; c < 3; c++) unit[c * pixels + i] = float(n[c] / std::hypot(n[0], n[1], n[2]));
  }
  return unit;
}

LoadedFrame load(const SuiteFrame& frame) {
  InputSettings settings;
  settings.input = frame.input;
  settings.camera = frame.camera;
  LoadedFrame loaded{read_host_frame(settings, 0), {}, {}, {}, {}, {}};
  const auto& host = loaded.host;
  for (const float z : host.depth) loaded.surface.push_back(std::isfinite(z) && z > 0 && z < host.sky);
  loaded.planar = planar_depths(host.depth, depth_map_of(host), view_of(host.camera, host.data, host.display));
  loaded.truth.assign(host.depth.size(), 0.0f);
  for (const auto& path : frame.truth) {
    const Image image = read_exr_image(path);
    if (image.data != host.data || image.names.size() != 1)
      fail(ErrorKind::input, "{}: the truth has {} channels over {}, and must have one over {}", path,
           image.names.size(), to_string(image.data), to_string(host.data));
    loaded.truths.push_back(image.pixels);
  }
  for (std::size_t i = 0; i < loaded.truth.size(); i++) {
    for (const auto& truth : loaded.truths) loaded.truth[i] += truth[i] / float(loaded.truths.size());
    if (!loaded.surface[i]) loaded.truth[i] = 1;
  }
  loaded.half = half_shadow(host.data.width, host.data.height, loaded.planar, std::numeric_limits<double>::infinity(),
                            unit_normals(host), loaded.truth);
  return loaded;
}

EstimatorSettings settings_for(const BenchCandidate& candidate, const SuiteFrame& frame) {
  EstimatorSettings settings = candidate.estimator;
  if (!settings.radius) settings.radius = frame.radius;
  return settings;
}

/// The timings of one candidate on one frame, run by run.
struct Timings {
  std::vector<std::vector<gpu::PassTime>> runs;

  void summarize(BenchRow& row) const {
    std::vector<double> totals;
    for (const auto& run : runs) {
      double total = 0;
      for (const auto& pass : run) total += pass.ms;
      totals.push_back(total);
    }
    row.ms = median_of(totals);
    const auto [least, most] = std::ranges::minmax(totals);
    row.ms_min = least;
    row.ms_max = most;
    for (std::size_t pass = 0; pass < runs[0].size(); pass++) {
      std::vector<double> times;
      for (const auto& run : runs) times.push_back(run[pass].ms);
      row.passes.push_back({runs[0][pass].name, median_of(times), *std::ranges::min_element(times),
                            runs[0][pass].bytes_read, runs[0][pass].bytes_written});
    }
  }
};

/// The median that the yardstick program prints for a frame.
double run_yardstick(const std::string& program, const SuiteFrame& frame, int runs) {
  const std::string command = fmt::format("{} {} {} {} {}", for_shell(program), for_shell(frame.input),
                                          for_shell(frame.camera), frame.radius, runs);
  const std::string text = output_of_command(command);
  const std::size_t at = text.find("median ");
  const double ms = at == text.npos ? 0 : std::atof(text.c_str() + at + 7);
  if (!(ms > 0)) fail(ErrorKind::usage, "--yardstick {}: it printed no \"median X ms\" for {}", program, frame.input);
  return ms;
}

/// References by what they depend on, so that candidates that differ in samples only share one.
class References {
 public:
  /// `kept`: a file that holds one of them; empty: none does.
  References(const LoadedFrame& frame, int slices, std::string kept)
      : frame_(frame), slices_(slices), kept_(std::move(kept)) {}

  /// Of several radii the mean, as the estimate is.
  std::vector<float> of(EstimatorSettings settings) {
    const auto radii = radii_of(settings);
    std::vector<float> mean(frame_.host.depth.size());
    for (const double radius : radii) {
      settings.radius = radius;
      std::ranges::transform(mean, of_one_radius(settings), mean.begin(),
                             [&](float sum, float ao) { return sum + ao / float(radii.size()); });
    }
    return mean;
  }

 private:
  const std::vector<float>& of_one_radius(const EstimatorSettings& settings) {
    ReferenceSettings wanted = reference_settings_of(settings, !frame_.host.behind.empty());
    wanted.slices = slices_;
    auto& reference = made_[fmt::format("{} hidden {}", text_of(wanted), wanted.hidden)];
    if (reference.empty() && !kept_.empty()) reference = read_kept_reference(kept_, wanted, frame_.host.data);
    if (reference.empty()) reference = reference_ao(frame_.host, wanted);
    return reference;
  }

  const LoadedFrame& frame_;
  int slices_;
  std::string kept_;
  std::map<std::string, std::vector<float>> made_;
};

/// Empty where there is one truth.
Values second_truth(const LoadedFrame& frame) { return frame.truths.size() == 2 ? Values(frame.truths[1]) : Values(); }

/// Over the surfaces, without the truths' noise where there are two.
PlaneErrors against_truth(const std::vector<float>& result, const LoadedFrame& frame) {
  return compare_planes(result, frame.truths[0], frame.surface, second_truth(frame));
}

/// Over the plain surfaces; a value that is not finite makes the 15 x 15 pixels about it no plain ones.
std::optional<double> grain_of(const BenchRow& row, const LoadedFrame& frame) {
  const int width = frame.host.data.width;
  const int height = frame.host.data.height;
  const Comparable values =
      make_comparable(row.frame, frame.planar.size(), row.ao, frame.truths[0], second_truth(frame), frame.surface);
  const auto plain = plain_pixels(width, height, frame.planar, std::numeric_limits<double>::infinity(), values.mask);
  return grain(width, height, plain, values.result, values.reference, values.reference_b);
}

/// Between three seeds, over the half shadow; an exact search has none.
std::optional<double> mottle_of(gpu::Recorder& gpu, const LoadedFrame& frame, EstimatorSettings settings) {
  if (searches_exactly(settings) || std::ranges::find(frame.half, 1) == frame.half.end()) return std::nullopt;
  std::vector<std::vector<float>> results;
  for (settings.seed = 1; settings.seed <= 3; settings.seed++)
    results.push_back(compute_ao(gpu, frame.host, settings).ao);
  return mottle(frame.half, results);
}

void measure(BenchRow& row, const LoadedFrame& frame, const EstimatorSettings& settings, References* references) {
  row.errors = against_truth(row.ao, frame);
  row.grain = grain_of(row, frame);
  if (!references) return;
  const auto reference = references->of(settings);
  row.estimator_rmse = compare_planes(row.ao, reference, frame.surface).rmse;
  row.geometry_rmse = against_truth(reference, frame).rmse;
}

}  // namespace

BenchReport run_bench(gpu::Device& device, const Suite& suite, const std::vector<BenchCandidate>& candidates,
                      const BenchOptions& options) {
  BenchReport report{suite.title, device.info().name, suite.repeats, {}, candidates, {}};
  gpu::Recorder gpu(device);
  for (const auto& frame : suite.frames) {
    const LoadedFrame loaded = load(frame);
    BenchFrame described{frame.name, loaded.host.data.width, loaded.host.data.height,
                         {},         loaded.host.depth,      loaded.truth};
    std::vector<Timings> timings(candidates.size());
    std::vector<HostResult> results(candidates.size());
    std::vector<double> yardsticks;
    // Round by round, so that a machine that slows down slows all candidates alike; the first round only warms up.
    for (int round = 0; round <= suite.repeats; round++) {
      if (options.say) options.say(fmt::format("{}: round {} of {}", frame.name, round, suite.repeats));
      if (!options.yardstick.empty() && round > 0) yardsticks.push_back(run_yardstick(options.yardstick, frame, 3));
      for (std::size_t c = 0; c < candidates.size(); c++) {
        results[c] = compute_ao(gpu, loaded.host, settings_for(candidates[c], frame));
        if (round > 0) timings[c].runs.push_back(gpu.passes());
      }
    }
    if (!yardsticks.empty()) described.yardstick_ms = median_of(yardsticks);
    if (options.say && suite.reference_slices) options.say(fmt::format("{}: CPU reference", frame.name));
    References references(loaded, suite.reference_slices, frame.reference);
    for (std::size_t c = 0; c < candidates.size(); c++) {
      const auto settings = settings_for(candidates[c], frame);
      BenchRow row;
      row.frame = frame.name;
      row.candidate = candidates[c].name;
      row.ao = std::move(results[c].ao);
      timings[c].summarize(row);
      const HostResult& result = results[c];
      const auto pixels = double(loaded.planar.size());
      const double blocks = double(settings.resolution) * double(settings.resolution);
      const double estimates = result.estimates ? result.estimates : (pixels - result.sky_pixels) / blocks;
      row.samples_per_pixel = samples_of(settings, estimates) / pixels;
      row.mottle = mottle_of(gpu, loaded, settings);
      measure(row, loaded, settings, suite.reference_slices ? &references : nullptr);
      report.rows.push_back(std::move(row));
    }
    report.frames.push_back(std::move(described));
  }
  return report;
}

// Reports.

namespace {

using Json = nlohmann::ordered_json;

Json number(std::optional<double> value) { return value ? Json(*value) : Json(nullptr); }

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
          {"rmse", row.errors.rmse},
          {"mae", row.errors.mae},
          {"bias", row.errors.bias},
          {"p99", row.errors.p99},
          {"grain", number(row.grain)},
          {"mottle", number(row.mottle)},
          {"estimator_rmse", number(row.estimator_rmse)},
          {"geometry_rmse", number(row.geometry_rmse)},
          {"passes", passes}};
}

/// A candidate's mean over the frames that have the measure; null where none has.
Json mean_of(const Json& rows, const std::string& candidate, const char* measure) {
  double sum = 0;
  int count = 0;
  for (const auto& row : rows) {
    if (row["candidate"] != candidate || row[measure].is_null()) continue;
    sum += double(row[measure]);
    count++;
  }
  return count ? Json(sum / count) : Json(nullptr);
}

/// A candidate's means over the frames.
Json to_json(const BenchCandidate& candidate, const Json& rows) {
  Json json = {{"name", candidate.name}, {"settings", candidate.settings_text}};
  for (const char* measure : {"ms", "ms_min", "samples_per_pixel", "rmse", "mae", "bias", "p99", "grain", "mottle"})
    json[measure] = mean_of(rows, candidate.name, measure);
  return json;
}

Json to_json(const BenchReport& report) {
  Json frames = Json::array(), candidates = Json::array(), rows = Json::array();
  for (const auto& frame : report.frames)
    frames.push_back({{"name", frame.name},
                      {"width", frame.width},
                      {"height", frame.height},
                      {"yardstick_ms", number(frame.yardstick_ms)}});
  for (const auto& row : report.rows) rows.push_back(to_json(row));
  for (const auto& candidate : report.candidates) candidates.push_back(to_json(candidate, rows));
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
  if (measure == "rmse") return row.errors.rmse;
  if (measure == "mae") return row.errors.mae;
  if (measure == "p99") return row.errors.p99;
  if (measure == "bias") return std::abs(row.errors.bias);
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
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", field(row.frame), field(row.candidate),
                    row.ms, row.ms_min, row.ms_max,
                    frame.yardstick_ms ? fmt::format("{}", row.ms / *frame.yardstick_ms) : "", row.samples_per_pixel,
                    row.errors.rmse, row.errors.mae, row.errors.bias, row.errors.p99, optional(row.estimator_rmse),
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
                      {"result", picture_url(frame.width, frame.height, 1, row.ao)},
                      {"truth", first ? Json(picture_url(frame.width, frame.height, 1, frame.truth)) : Json(nullptr)},
                      {"error", url_of_png(error_png(frame.width, frame.height, row.ao, frame.truth))}});
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
