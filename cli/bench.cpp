// `alcove bench SUITE.toml`: run time against error, as a table, JSON, CSV and a page.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/bench.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "core/base/file.h"
#include "core/bench/stability.h"
#include "core/gpu/device.h"
#include "core/options/options.h"

namespace alcove {
namespace {

struct BenchArguments {
  std::string suite, data, json, csv, report, limits, yardstick;
  gpu::DeviceOptions device;
  int repeats = 0, reference_slices = -1;
  bool quiet = false, stability = false;
};

CommandOf<BenchArguments> bench_syntax() {
  using S = BenchArguments;
  CommandOf<BenchArguments> command{"alcove bench",
                                    "Measures device time against error for the candidates of a suite.\n\n"
                                    "Example:\n  alcove bench examples/bench/suite.toml --report bench.html\n"};
  OptionGroup suites(command.rows, "", Effect::none);
  suites.text("SUITE", &S::suite, "", "a suite file (TOML); all but --stability needs one")
      .names(FileRole::input)
      .is_of_frame = false;
  OptionGroup options(command.rows, "Options", Effect::none);
  // A count of 0 stands for "not given", and no default is shown for it.
  const auto count = [&](const char* name, int BenchArguments::*value, const Range& range, const char* sentence) {
    options.number(name, value, "", range, sentence).default_text.clear();
  };
  options.text("--data", &S::data, "FOLDER", "the folder of the suite's frames; else the suite's own");
  options.flag("--stability", &S::stability,
               "without a suite: find where each estimator fails numerically, along depth, radius, field of view, "
               "tilt, bits and world offset");
  count("--repeats", &S::repeats, between(1, 1000), "timed runs, instead of the suite's");
  count("--reference-slices", &S::reference_slices, between(0, 1024),
        "of the CPU reference, instead of the suite's; 0: none");
  const auto file = [&](const char* name, std::string S::*path, const char* value, const char* sentence,
                        FileRole role) { options.text(name, path, value, sentence).names(role).is_of_frame = false; };
  file("--json", &S::json, "FILE.json", "write all numbers", FileRole::report);
  file("--csv", &S::csv, "FILE.csv", "write a line for every candidate and frame", FileRole::report);
  file("--report", &S::report, "FILE.html", "write a self-contained page with chart, table and pictures",
       FileRole::report);
  file("--limits", &S::limits, "FILE.toml", "a TOML file of largest errors; a larger error ends with exit code 6",
       FileRole::input);
  file("--yardstick", &S::yardstick, "PROGRAM",
       "a program that times a unit of work, run between the candidates as PROGRAM FRAME CAMERA RADIUS RUNS; it prints "
       "\"median X ms\"",
       FileRole::input);
  options.text("--device", within(&S::device, &gpu::DeviceOptions::choice), "auto|cpu|INDEX|NAME|UUID",
               "as for alcove run");
  options.flag("--require-gpu", within(&S::device, &gpu::DeviceOptions::require_gpu),
               "measuring on the CPU is an error");
  options.flag("-q,--quiet", &S::quiet, "no progress and no table");
  return command;
}

/// Fails without a suite, and on options that --stability, which measures something else, would ignore.
void check_purpose(const BenchArguments& a) {
  if (a.suite.empty() && !a.stability)
    fail(ErrorKind::usage, "alcove bench: SUITE is required; try alcove bench --help");
  if (!a.stability) return;
  const std::initializer_list<std::pair<const char*, bool>> others{{"SUITE", !a.suite.empty()},
                                                                   {"--data", !a.data.empty()},
                                                                   {"--csv", !a.csv.empty()},
                                                                   {"--limits", !a.limits.empty()},
                                                                   {"--yardstick", !a.yardstick.empty()},
                                                                   {"--repeats", a.repeats > 0},
                                                                   {"--reference-slices", a.reference_slices >= 0}};
  for (const auto& [option, is_given] : others)
    if (is_given) fail(ErrorKind::usage, "{} does not apply with --stability; give only one of them", option);
}

/// Whether the candidate names a radius of its own, as "--radius=0.5".
bool names_radius(const SuiteCandidate& candidate) {
  return std::ranges::any_of(candidate.arguments, [](const auto& word) { return word.starts_with("--set=radius="); });
}

/// The candidate's settings for a frame: its options go the way that alcove run's go.
Settings settings_of(const SuiteCandidate& candidate, const SuiteFrame& frame, const std::string& suite) {
  RunOptions options;
  Settings& settings = options.settings;
  try {
    if (!parse_run_options(candidate.arguments, options))
      fail(ErrorKind::usage, "it asks for what only alcove run prints");
    EstimatorSettings& estimator = settings.estimator;
    if ((estimator.radius_auto || estimator.radius_in_medians) && names_radius(candidate))
      fail(ErrorKind::usage, "--radius {}: without a --radius each frame is measured at that of its truth",
           estimator.radius_auto ? "auto" : "in percent");
    estimator.radius_auto = estimator.radius_in_medians = false;
    settings.input.input = frame.input;
    settings.input.camera = frame.camera;
    Settings checked = settings;
    checked.output.output = "ao.exr";
    if (!checked.estimator.radius) checked.estimator.radius = frame.radius;
    check_settings(checked);
  } catch (const Error& error) {
    fail(error.kind(), "{}: candidate {}: {}", suite, candidate.name, error.what());
  }
  return settings;
}

/// Refuses to write over what is read: files of options, and of the suite.
void check_reports(const BenchArguments& arguments, const std::vector<RowOf<BenchArguments>>& rows,
                   const Suite& suite) {
  FileUses uses;
  for (const auto& file : files_of(rows, arguments, FileRole::input)) uses.add_input(file);
  for (const auto& frame : suite.frames)
    for (const auto& path : frame.files()) uses.add_input({"SUITE", path});
  for (const auto& candidate : suite.candidates)
    for (const auto& file : files_of(settings_of(candidate, suite.frames.front(), arguments.suite), FileRole::input))
      uses.add_input(file);
  for (const auto& file : files_of(rows, arguments, FileRole::report)) {
    uses.add_output(file);
    require_writable(file.path, file.option.c_str());
  }
}

std::vector<BenchCandidate> candidates_of(const Suite& suite, const std::string& path) {
  std::vector<BenchCandidate> candidates;
  for (const auto& candidate : suite.candidates) {
    EstimatorSettings estimator = settings_of(candidate, suite.frames.front(), path).estimator;
    if (!names_radius(candidate)) {
      // The radii of a preset do not count: each frame is measured at the radius of its truth.
      estimator.radius.reset();
      estimator.further_radii.clear();
    }
    candidates.push_back({candidate.name, fmt::format("{}", fmt::join(candidate.arguments, " ")), estimator});
  }
  return candidates;
}

void print_table(const BenchReport& report) {
  fmt::print("{:<14} {:<24} {:>9} {:>7} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}\n", "frame", "candidate", "ms",
             "yards", "rmse", "bias", "p99", "grain", "mottle", "estimator", "geometry");
  for (const auto& row : report.rows) {
    const auto& frame = *std::ranges::find(report.frames, row.frame, &BenchFrame::name);
    const auto number = [](std::optional<double> value) { return value ? fmt::format("{:.4f}", *value) : "-"; };
    fmt::print("{:<14} {:<24} {:>9.2f} {:>7} {:>8.4f} {:>+8.4f} {:>8.4f} {:>8} {:>8} {:>9} {:>9}\n", row.frame,
               row.candidate, row.ms, frame.yardstick_ms ? fmt::format("{:.2f}", row.ms / *frame.yardstick_ms) : "-",
               row.errors.rmse, row.errors.bias, row.errors.p99, number(row.grain), number(row.mottle),
               number(row.estimator_rmse), number(row.geometry_rmse));
  }
}

void write(const std::string& path, const std::string& text) {
  if (!path.empty()) write_whole(path, text);
}

int report_stability(const BenchArguments& a) {
  gpu::Device device(a.device);
  const StabilityReport report = run_stability(device, [&](const std::string& line) {
    if (!a.quiet) print_error("{}\n", line);
  });
  if (!a.quiet) fmt::print("{}", stability_text(report));
  write(a.json, stability_json(report));
  write(a.report, stability_page(report));
  return 0;
}

}  // namespace

Command describe_bench() { return bench_syntax().shown(); }

int bench_command(const std::vector<std::string>& arguments) {
  const auto syntax = bench_syntax();
  const auto parsed = syntax.parse(arguments);
  if (!parsed) return 0;
  const BenchArguments& a = *parsed;
  check_purpose(a);
  check_reports(a, syntax.rows, {});
  if (a.stability) return report_stability(a);
  Suite suite = read_suite(a.suite, a.data);
  if (a.repeats) suite.repeats = a.repeats;
  if (a.reference_slices >= 0) suite.reference_slices = a.reference_slices;
  check_reports(a, syntax.rows, suite);
  const auto limits = a.limits.empty() ? std::vector<Limit>() : read_limits(a.limits);
  require_known(limits, suite, a.limits);
  const auto candidates = candidates_of(suite, a.suite);

  gpu::Device device(a.device);
  BenchOptions options;
  options.yardstick = a.yardstick;
  if (!a.quiet) options.say = [](const std::string& line) { print_error("{}\n", line); };
  const BenchReport report = run_bench(device, suite, candidates, options);

  if (!a.quiet) print_table(report);
  write(a.json, bench_json(report));
  write(a.csv, bench_csv(report));
  if (!a.report.empty()) write(a.report, bench_page(report));
  if (a.limits.empty()) return 0;
  const auto broken = broken_limits(report, limits);
  for (const auto& sentence : broken) print_error("alcove: {}\n", sentence);
  return broken.empty() ? 0 : int(ErrorKind::comparison);
}

}  // namespace alcove
