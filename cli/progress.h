// Tells of a run while it goes on: a bar for people, lines for logs, and the words that farms look for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/base/error.h"
#include "core/options/options.h"
#include "core/run/run_report.h"

namespace alcove {

/// Messages go to the standard error; "Progress: 42%" and "openjd_progress: 42" to the standard output. Every line is
/// whole and flushed.
class Progress {
 public:
  /// log_json names a file, or is - for the standard output, or is empty for no log. begin() fails with
  /// ErrorKind::output where the log cannot be written. If it breaks off later, end() fails, and the frames go on. All
  /// functions fail with ErrorKind::output where the standard output cannot be written.
  Progress(const ProgressSettings& options, const std::string& log_json, bool tells_presets = true);

  void begin(const RunReport& report, int frames);
  /// Prints the new notes of RunReport::notes.
  void note(const RunReport& report);
  void frame(const FrameReport& frame);
  /// Tells how far the frames in flight are, once one of them takes long.
  void working(std::span<const FrameProgress> frames);
  void end(const RunReport& report);

 private:
  static constexpr double kFirstTold = 10;  // seconds that a frame takes
  struct CloseFile {
    void operator()(std::FILE* file) const { (void)std::fclose(file); }
  };
  void open_log();
  void say(const std::string& line);
  void say(const std::string& file, const Note& note);
  void say_presets(std::vector<std::string> files);
  void note_frame(const FrameReport& frame);
  void say_further();
  void show_bar();
  void tell_people(const FrameReport& frame);
  void tell_people_of_work(std::span<const FrameProgress> frames);
  /// Lines that a farm reads: it asked for them, so even a quiet run prints them.
  void tell_farm(const FrameReport& frame);
  void tell_farm_of_work(std::span<const FrameProgress> frames);
  bool raise_percent(double percent);
  void print_percent() const;
  void take_line_away();
  void log(const std::string& event, const std::string& members);
  std::string rate_text() const;

  ProgressSettings options_;
  bool tells_presets_;  // false where a run before has told of the same
  const std::string log_path_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::FILE* log_ = nullptr;
  std::optional<Error> log_failure_;  // no event is written after it
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  bool is_sequence_ = false;
  int frames_ = 0, ended_ = 0, computed_ = 0;
  bool is_line_shown_ = false;       // of a bar, or of a frame in work: the next line takes its place
  double next_told_s_ = kFirstTold;  // from when on plain lines tell of a frame again
  double percent_ = 0;               // of the run, in tenths, the most that was told: it never falls
  Notes of_all_;                     // the notes of the whole run
  std::map<NoteCode, int> further_;  // of a sequence: codes that were said of a frame, and the further frames with them
};

}  // namespace alcove
