// `alcove compare RESULT REFERENCE`: how far pictures or sequences are apart, as a table, JSON, a page, and an exit
// code.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/compare.h"

#include <cmath>
#include <filesystem>

#include "cli/commands.h"
#include "core/base/file.h"
#include "core/base/frame_list.h"
#include "core/base/text.h"
#include "core/options/options.h"

namespace alcove {
namespace {

struct CompareArguments {
  CompareSettings settings;
  std::string report, junit;
  bool json = false, quiet = false;
};

CommandOf<CompareArguments> compare_syntax() {
  using S = CompareSettings;
  CommandOf<CompareArguments> command{
      "alcove compare",
      "Measures how far a picture or a sequence is from a reference.\n\n"
      "Examples:\n"
      "  alcove compare ao.exr truth.exr --depth frame.exr --max-rmse 0.1\n"
      "  alcove compare ao.%04d.exr truth.%04d.exr --depth frame.%04d.exr --motion frame.%04d.exr --json\n"};
  OptionGroup pictures(command.rows, "", Effect::none, &CompareArguments::settings);
  pictures.text("RESULT", &S::result, "", "an EXR or any other picture; a pattern such as ao.%04d.exr for a sequence")
      .names(FileRole::input)
      .is_required = true;
  pictures
      .text("REFERENCE", &S::reference, "",
            "the reference; a pattern too, one picture for all frames, or a list of frames in TOML")
      .names(FileRole::input)
      .is_required = true;
  OptionGroup options(command.rows, "Options", Effect::none, &CompareArguments::settings);
  OptionGroup reports(command.rows, "Options", Effect::none);
  const auto file = [&](const char* name, std::string S::*path, const char* value, const char* sentence) {
    options.text(name, path, value, sentence).names(FileRole::input);
  };
  file("--reference-b", &S::reference_b, "FILE",
       "a second render of the reference with independent noise: rmse is then free of the noise of both");
  options
      .add(
          {"--channel", "NAMES", "", "",
           "names with commas, or RESULT=REFERENCE pairs; may be given more than once; else the only channel of each, "
           "else those of the same name"},
          [](const S&) { return Words(); },
          [](S& s, const Words& words) { s.channels = fmt::format("{}", fmt::join(words, ",")); })
      .repeats = true;
  file("--mask", &S::mask, "FILE", "compare only where it is above 0");
  options.text("--mask-channel", &S::mask_channel, "NAME", "the mask's channel; else its only one, or its alpha");
  file("--depth", &S::depth, "FILE.exr", "leave out the sky, and measure depth edges and grain too");
  options.text("--depth-channel", &S::depth_channel, "NAME", "the depth channel; else found by its usual names");
  options.number("--sky", &S::sky, "", above(0), "depth at or beyond it is sky, as are 0, infinity and NaN");
  options.text("--frames", &S::frames, "LIST", "frames such as 1001-1100x2,1200; else the files of RESULT on the disk");
  file("--motion", &S::motion, "FILE",
       "motion for the flicker of a sequence: place in the previous frame minus place here, in pixels, y up");
  options.text("--motion-channels", &S::motion_channels, "X,Y", "the motion's channels; else Vector.X,Vector.Y");
  options.number("--peak", &S::peak, "", above(0), "the largest value, for PSNR and SSIM");
  options.flag("--hdr", &S::hdr, "the values are scene-linear light: HDR-FLIP instead of FLIP of display values");
  reports.flag("--json", &CompareArguments::json, "print JSON");
  reports
      .text("--report", &CompareArguments::report, "FILE.html", "write a self-contained page with table and pictures")
      .names(FileRole::report);
  reports
      .text("--junit", &CompareArguments::junit, "FILE.xml",
            "write a test case for each frame, and beside it FILE.NAME.error.png for each that fails")
      .names(FileRole::report);
  reports.flag("-q,--quiet", &CompareArguments::quiet,
               "print no table and no warnings: the exit code says whether limits hold");
  OptionGroup limits(command.rows, "Limits, for every frame; one that is broken ends with exit code 6", Effect::none,
                     within(&CompareArguments::settings, &CompareSettings::limits));
  for (const auto& row : kLimitTable)
    limits.number(row.option, row.value, "", row.high == kNoLimit ? at_least(row.low) : between(row.low, row.high),
                  row.sentence);
  return command;
}

/// Refuses options that say something of a file that is not there.
void check_files(const CompareSettings& s) {
  const auto require = [](bool is_said, const char* option, const std::string& file, const char* file_option) {
    if (is_said && file.empty())
      fail(ErrorKind::usage, "{}: applies with {} only, and there is none", option, file_option);
  };
  require(!s.mask_channel.empty(), "--mask-channel", s.mask, "--mask");
  require(!s.depth_channel.empty(), "--depth-channel", s.depth, "--depth");
  require(s.sky != CompareSettings().sky, "--sky", s.depth, "--depth");
  require(!s.motion_channels.empty(), "--motion-channels", s.motion, "--motion");
  if (!is_frame_list(s.reference)) return;
  for (const auto& [option, value] : {std::pair{"--frames", s.frames}, std::pair{"--motion", s.motion}})
    if (!value.empty())
      fail(ErrorKind::usage, "{} {}: it is for a sequence, and {} is a list of unlike frames", option, value,
           s.reference);
}

/// Refuses a limit of grain, also one that a list has, where there is no depth.
void check_grain(const std::vector<CompareSettings>& frames) {
  for (const auto& frame : frames)
    if (frame.limits.max_grain && frame.depth.empty())
      fail(ErrorKind::usage,
           "--max-grain {}: grain is measured on plain surfaces, and only depth shows where they are; give --depth "
           "FILE.exr",
           *frame.limits.max_grain);
}

/// Refuses to write over a picture of any frame.
void check_report(const CompareArguments& arguments, const std::vector<CompareSettings>& frames,
                  const std::vector<RowOf<CompareArguments>>& rows) {
  if (arguments.report.empty() && arguments.junit.empty()) return;
  FileUses uses;
  if (is_frame_list(arguments.settings.reference)) uses.add_input({"REFERENCE", arguments.settings.reference});
  CompareArguments of_frame;
  for (const auto& settings : frames) {
    of_frame.settings = settings;
    for (const auto& file : files_of(rows, of_frame, FileRole::input)) uses.add_input(file);
  }
  if (!arguments.junit.empty())
    for (const auto& settings : frames)
      uses.add_output({"--junit", failure_path(arguments.junit, name_of(settings))}, " of frame " + name_of(settings));
  for (const auto& file : files_of(rows, arguments, FileRole::report)) {
    uses.add_output(file);
    require_makeable(file.path, file.option.c_str());
  }
}

/// A number with four decimals, or with two digits where those would hide it.
std::string number(double value) {
  return value != 0 && std::abs(value) < 0.001 ? fmt::format("{:.1e}", value) : fmt::format("{:.4f}", value);
}
std::string signed_number(double value) { return (value < 0 ? "" : "+") + number(value); }
std::string optional_number(std::optional<double> value) { return value ? number(*value) : "-"; }

void print_part(const std::string& name, const PartErrors& part) {
  fmt::print("  {:<22} {:>9} values   rmse {}   bias {}\n", name, part.count, number(part.rmse),
             signed_number(part.bias));
}

void print_heading(const std::string& result, const std::string& reference, const std::vector<std::string>& channels) {
  fmt::print("{}\n", printable(fmt::format("{} against {}: {}", result, reference, fmt::join(channels, ", "))));
}

void print_picture(const FrameComparison& c) {
  print_heading(c.result, c.reference, c.channels);
  fmt::print("  {} compared, {} masked, {} not finite, {} of them in one file only\n", counted(c.count, "pixel"),
             c.masked, c.excluded, c.holes);
  if (c.common) fmt::print("  the files' windows differ: compared {}, which all have\n", to_string(*c.common));
  const PlaneErrors& e = c.errors;
  fmt::print("  rmse {}   mae {}   bias {}   max {}   p95 {}   p99 {}\n", number(e.rmse), number(e.mae),
             signed_number(e.bias), number(e.max), number(e.p95), number(e.p99));
  fmt::print("  psnr {:.2f} dB   ssim {}   flip {}   grain {}\n", c.psnr, optional_number(c.ssim), number(c.flip),
             optional_number(c.grain));
  for (const auto& band : c.bands)
    print_part(fmt::format("reference {:.2f} to {:.2f}", band.from, band.to), band.errors);
  if (!c.edges) return;
  print_part("at depth edges", c.edges->at);
  print_part("away from them", c.edges->away);
}

void print_sequence(const CompareReport& report) {
  print_heading(report.result, report.reference, report.frames[0].channels);
  const auto longest = std::ranges::max_element(report.frames, {}, [](const auto& c) { return c.name.size(); });
  const std::size_t width = std::max<std::size_t>(7, longest->name.size());
  fmt::print("{:>{}} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "frame", width, "pixels", "rmse", "mae",
             "bias", "p99", "psnr", "ssim", "flip", "grain");
  double sum = 0;
  for (const auto& c : report.frames) {
    const PlaneErrors& e = c.errors;
    fmt::print("{:>{}} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8.2f} {:>8} {:>8} {:>8}\n", c.name, width, c.count,
               number(e.rmse), number(e.mae), signed_number(e.bias), number(e.p99), c.psnr, optional_number(c.ssim),
               number(c.flip), optional_number(c.grain));
    sum += e.rmse;
  }
  for (const auto& failed : report.failed) fmt::print("{:>{}} not compared\n", printable(failed.name), width);
  const auto part = std::ranges::find_if(report.frames, [](const auto& c) { return c.common.has_value(); });
  if (part != report.frames.end())
    fmt::print("the files' windows differ: compared what all have, in frame {} {}\n", part->name,
               to_string(*part->common));
  const auto& worst = worst_frame(report);
  fmt::print("worst: frame {}, rmse {}; mean rmse {}{}\n", worst.name, number(worst.errors.rmse),
             number(sum / double(report.frames.size())),
             report.is_sequence ? "; flicker " + optional_number(report.flicker) : "");
}

void write_junit(const CompareReport& report, const std::string& path) {
  make_folder_of(path, "--junit");
  for (const auto& frame : report.frames)
    if (fails(frame, report)) write_whole(failure_path(path, frame.name), frame.error_png);
  write_whole(path, compare_junit(report, path));
}

/// Removes the reports of an earlier comparison.
void remove_reports(const CompareArguments& arguments, const std::vector<CompareSettings>& frames) {
  std::vector<std::string> paths{arguments.report, arguments.junit};
  if (!arguments.junit.empty())
    for (const auto& frame : frames) paths.push_back(failure_path(arguments.junit, name_of(frame)));
  remove_earlier(paths);
}

void print_report(const CompareReport& report, const CompareArguments& arguments,
                  const std::vector<CheckedLimit>& limits) {
  if (arguments.json)
    fmt::print("{}\n", compare_json(report, limits));
  else if (report.has_several() && !arguments.quiet)
    print_sequence(report);
  else if (!arguments.quiet)
    print_picture(report.frames[0]);
  if (arguments.quiet) return;
  for (const auto& note : notes_on(report, arguments.settings))
    print_error("alcove: {}: {}\n", level_of(note), printable(line_of(note, "")));
}

/// Fails where a frame could not be compared, or a limit is broken.
void fail_where_broken(const CompareReport& report, const std::vector<CheckedLimit>& limits) {
  std::vector<std::string> sentences = errors_in(report);
  if (has_limits(report)) std::ranges::copy(broken_limits(limits), std::back_inserter(sentences));
  if (sentences.empty()) return;
  const bool is_unread =
      !report.failed.empty() || std::ranges::any_of(limits, [](const auto& l) { return l.kind == ErrorKind::input; });
  fail(is_unread ? ErrorKind::input : ErrorKind::comparison, "{}", fmt::join(sentences, "; "));
}

}  // namespace

Command describe_compare() { return compare_syntax().shown(); }

int compare_command(const std::vector<std::string>& arguments) {
  const auto syntax = compare_syntax();
  auto parsed = syntax.parse(arguments);
  if (!parsed) return 0;
  CompareArguments& a = *parsed;
  check_files(a.settings);
  const std::vector<CompareSettings> frames = settings_of_frames(a.settings);
  check_grain(frames);
  check_report(a, frames, syntax.rows);
  a.settings.pictures = !a.report.empty();
  a.settings.failures = !a.junit.empty();
  remove_reports(a, frames);

  const CompareReport report = compare_pictures(a.settings);
  if (!a.junit.empty()) write_junit(report, a.junit);
  if (report.frames.empty()) {
    if (a.json) fmt::print("{}\n", compare_json(report, {}));
    fail_where_broken(report, {});
  }
  const auto limits = checked_limits(report);
  print_report(report, a, limits);
  if (!a.report.empty()) {
    make_folder_of(a.report, "--report");
    write_whole(a.report, compare_page(report, limits));
  }
  fail_where_broken(report, limits);
  return 0;
}

}  // namespace alcove
