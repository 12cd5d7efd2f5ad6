// Bar, lines, records.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/progress.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/commands.h"
#include "cli/options.h"
#include "core/base/text.h"

namespace alcove {
namespace {

constexpr int kBarWidth = 30;

std::string clock_text(double seconds) {
  const int s = int(seconds);
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

Progress::Progress(const ProgressSettings& options, const std::string& log_json, bool tells_presets)
    : options_(options), tells_presets_(tells_presets), log_path_(log_json) {
  if (options_.kind == "auto") options_.kind = errors_go_to_terminal() ? "bar" : "plain";
}

void Progress::open_log() {
  if (log_path_.empty()) return;
  // A symbolic link is replaced and not followed, as all outputs are; a log begins anew.
  std::error_code none;
  if (log_path_ != "-" && std::filesystem::is_symlink(log_path_, none)) std::filesystem::remove(log_path_, none);
  if (log_path_ != "-") file_.reset(std::fopen(log_path_.c_str(), "wb"));
  log_ = log_path_ == "-" ? stdout : file_.get();
  if (!log_) fail(ErrorKind::output, "{}: cannot be written: {} (--log-json)", log_path_, std::strerror(errno));
}

void Progress::say(const std::string& line) {
  take_line_away();
  print_error("{}\n", line);
}

void Progress::take_line_away() {
  if (std::exchange(is_line_shown_, false)) print_error("\r\x1b[K");
}

void Progress::log(const std::string& event, const std::string& members) {
  if (!log_) return;
  const double now = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  const std::string line = fmt::format("{{\"event\":\"{}\",\"time\":{:.3f},{}}}\n", event, now, members);
  if (log_failure_ || (std::fputs(line.c_str(), log_) >= 0 && std::fflush(log_) == 0)) return;
  log_failure_.emplace(ErrorKind::output,
                       fmt::format("{}: cannot be written: {} (--log-json)", log_path_, std::strerror(errno)));
}

void Progress::begin(const RunReport& report, int frames) {
  is_sequence_ = report.is_sequence;
  frames_ = frames;
  open_log();  // now that the run's checks have let it through
  log("begin", fmt::format("\"frames\":{},\"options\":\"{}\",\"presets\":{},\"notes\":{}", frames, report.options,
                           json_text(report.presets), notes_json(report.notes)));
  if (log_failure_) throw *log_failure_;  // before a frame has taken any time
  if (tells_presets_) say_presets(report.presets);
  note(report);
}

/// A name may stand for a file of the show, of the user or of the program: those of the program need no word.
void Progress::say_presets(std::vector<std::string> files) {
  const auto plain = [](const std::string& path) { return std::filesystem::path(path).generic_string(); };
  std::erase_if(files, [&](const auto& file) { return plain(file).starts_with(plain(preset_folder()) + "/"); });
  if (!files.empty() && !options_.quiet) say(printable(fmt::format("alcove: settings of {}", fmt::join(files, ", "))));
}

void Progress::say(const std::string& file, const Note& note) {
  if (options_.quiet) return;
  say(printable(fmt::format("alcove: {}: {}", level_of(note), line_of(note, file))));
}

void Progress::note(const RunReport& report) {
  for (std::size_t i = of_all_.size(); i < report.notes.size(); i++) {
    const Note& note = report.notes[i];
    say(note.code == NoteCode::no_gpu ? "" : report.input, note);
  }
  of_all_ = report.notes;
}

void Progress::note_frame(const FrameReport& frame) {
  std::set<NoteCode> here;
  for (const auto& note : frame.notes) {
    if (std::ranges::find(of_all_, note) != of_all_.end()) continue;
    here.insert(note.code);
    if (!further_.contains(note.code)) say(frame.input, note);
  }
  for (const NoteCode code : here)
    if (const auto [known, is_new] = further_.try_emplace(code, 0); !is_new) known->second++;
}

void Progress::say_further() {
  for (const auto& [code, frames] : further_)
    if (frames) say("and in " + counted(std::size_t(frames), "further frame"), {code, facts_of(code).meaning});
}

std::string Progress::rate_text() const {
  if (computed_ == 0) return fmt::format("{} of {}", ended_, frames_);  // what is kept says nothing of the time
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(),
               each = seconds / computed_;
  return fmt::format("{} of {}, {:.2f} frames/s, {} left", ended_, frames_, 1 / each,
                     clock_text(each * (frames_ - ended_)));
}

void Progress::show_bar() {
  const int full = kBarWidth * ended_ / std::max(1, frames_);
  print_error("\r\x1b[K[{:#<{}}{:.<{}}] {}", "", full, "", kBarWidth - full, rate_text());
  is_line_shown_ = true;
  (void)std::fflush(stderr);
}

void Progress::working(std::span<const FrameProgress> frames) {
  if (!options_.quiet) tell_people_of_work(frames);
  tell_farm_of_work(frames);
}

void Progress::tell_people_of_work(std::span<const FrameProgress> frames) {
  constexpr double kLong = 2;          // seconds, from which on a person wants to know
  constexpr double kMostSilent = 300;  // seconds
  const auto slowest = std::ranges::max_element(frames, {}, &FrameProgress::seconds);
  if (slowest == frames.end() || slowest->seconds < kLong) return;
  std::string text = fmt::format("{}: {} so far", slowest->input, clock_text(slowest->seconds));
  if (slowest->parts > 1) text += fmt::format(", part {} of {}", slowest->part, slowest->parts);
  if (slowest->done > 0) text += fmt::format(", {:.0f} % of it computed", std::floor(100 * slowest->done));
  if (options_.kind == "plain" && slowest->seconds >= next_told_s_) {
    // Ever more seldom, so that logs stay short, but not so seldom that a run seems to hang.
    next_told_s_ = slowest->seconds + std::min(slowest->seconds, kMostSilent);
    say(printable(text));
  }
  if (options_.kind != "bar") return;
  if (is_sequence_) show_bar();
  print_error("{}{}", is_sequence_ ? " | " : "\r\x1b[K", printable(text));
  is_line_shown_ = true;
  (void)std::fflush(stderr);
}

void Progress::frame(const FrameReport& frame) {
  next_told_s_ = kFirstTold;
  ended_++;
  computed_ += frame.state != FrameState::kept;
  const std::string record = frame_json(frame);
  log("frame", record.substr(1, record.size() - 2));
  if (frame.error && is_sequence_)
    say(printable(fmt::format("alcove: error: frame {}: {}", frame.frame, frame.error->what())));
  if (frame.state == FrameState::done) note_frame(frame);
  if (!options_.quiet) tell_people(frame);
  tell_farm(frame);
}

void Progress::tell_people(const FrameReport& frame) {
  if (options_.verbose)
    for (const auto& pass : frame.passes)
      say(printable(fmt::format("{}: {} {:.3f} ms", frame.input, pass.name, pass.ms)));
  if (options_.kind == "plain" || (options_.kind == "bar" && !is_sequence_)) {
    const std::string place = is_sequence_ ? fmt::format(" ({})", rate_text()) : "";
    if (frame.state == FrameState::kept) say(printable(fmt::format("{}: whole, kept{}", frame.output, place)));
    if (frame.state == FrameState::done)
      say(printable(fmt::format("{} -> {}: read {:.0f} ms, compute {:.1f} ms, write {:.0f} ms{}", frame.input,
                                frame.output, frame.read_ms, frame.compute_ms, frame.write_ms, place)));
  }
  if (options_.kind == "bar" && is_sequence_) show_bar();
}

/// Whether the run is farther than was told, in the steps that are printed.
bool Progress::raise_percent(double percent) {
  const double step = options_.kind == "percent" ? 1 : 0.1;
  const double before = std::exchange(percent_, std::max(percent_, percent));
  return std::floor(percent_ / step) > std::floor(before / step);
}

void Progress::print_percent() const {
  if (options_.kind == "percent") fmt::print("Progress: {:.0f}%\n", std::floor(percent_));
  if (options_.kind == "openjd") fmt::print("openjd_progress: {:.1f}\n", percent_);
}

void Progress::tell_farm(const FrameReport& frame) {
  raise_percent(100.0 * ended_ / std::max(1, frames_));
  print_percent();
  if (options_.kind == "openjd") fmt::print("openjd_status: frame {} {}\n", frame.frame, name_of(frame.state));
  (void)std::fflush(stdout);
}

void Progress::tell_farm_of_work(std::span<const FrameProgress> frames) {
  // A run is whole only once its last frame is written.
  constexpr double kMost = 99.9;
  double done = ended_;
  for (const auto& frame : frames) done += frame.done;
  if (!raise_percent(std::min(100 * done / std::max(1, frames_), kMost))) return;
  print_percent();
  (void)std::fflush(stdout);
}

void Progress::end(const RunReport& report) {
  const std::string summary = summary_of(report);
  log("end",
      fmt::format("\"done\":{},\"kept\":{},\"failed\":{},\"warned\":{},\"dropped\":{},\"missing\":{},\"wall_s\":{:.3f}",
                  report.done, report.kept, report.failed, report.warned, report.dropped, report.missing.size(),
                  report.wall_s));
  if (options_.kind == "openjd" && (report.failed || report.stop)) fmt::print("openjd_fail: {}\n", summary);
  (void)std::fflush(stdout);
  if (!options_.quiet) say_further();
  if (!options_.quiet && is_sequence_) say(printable("alcove: " + summary));
  take_line_away();  // for an error that is told after the run, or for the shell
  (void)std::fflush(stderr);
  if (!log_failure_) return;
  if (!report.stop && report.failed == 0) throw *log_failure_;
  say(printable(fmt::format("alcove: error: {}", log_failure_->what())));  // beside that of the frames
}

}  // namespace alcove
