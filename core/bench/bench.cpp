// Measuring: interleaved timing, errors and their two parts.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/bench.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <tuple>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "core/chain/estimate/estimate.h"
#include "core/formats/exr.h"
#include "core/frame/find/frame_source.h"
#include "core/frame/pixels/statistics.h"
#include "core/gpu/recorder.h"
#include "core/measure/metrics.h"

namespace alcove {

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

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
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
    row.ms = median(totals);
    const auto [least, most] = std::ranges::minmax(totals);
    row.ms_min = least;
    row.ms_max = most;
    for (std::size_t pass = 0; pass < runs[0].size(); pass++) {
      std::vector<double> times;
      for (const auto& run : runs) times.push_back(run[pass].ms);
      row.passes.push_back({runs[0][pass].name, median(times), *std::ranges::min_element(times),
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
    auto& reference = made_[{wanted.radius, wanted.falloff, wanted.falloff_start, wanted.thickness,
                             wanted.thickness_length, wanted.bias, wanted.complete, wanted.hidden}];
    if (reference.empty() && !kept_.empty()) reference = read_kept_reference(kept_, wanted, frame_.host.data);
    if (reference.empty()) reference = reference_ao(frame_.host, wanted);
    return reference;
  }

  const LoadedFrame& frame_;
  int slices_;
  std::string kept_;
  std::map<std::tuple<double, Falloff, double, ThicknessRule, double, double, Completion, int>, std::vector<float>>
      made_;
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
  const PlaneErrors errors = against_truth(row.ao, frame);
  row.rmse = errors.rmse;
  row.mae = errors.mae;
  row.bias = errors.bias;
  row.p99 = errors.p99;
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
    if (!yardsticks.empty()) described.yardstick_ms = median(yardsticks);
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

}  // namespace alcove
