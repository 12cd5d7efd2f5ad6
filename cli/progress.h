// Tells of a run while it goes on: a bar for people, lines for logs, and the words that farms look for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include "core/options/options.h"
#include "core/run/run_report.h"

namespace alcove {

/// Messages go to the standard error; "Progress: 42%" and "openjd_progress: 42" to the standard output. Every line is
/// whole and flushed.
class Progress {
 public:
  /// log_json names a file, or is - for the standard output, or is empty for no log. All functions fail with
  /// ErrorKind::output where the log or the standard output cannot be written.
  Progress(const ProgressOptions& options, const std::string& log_json);

  void begin(const RunReport& report, int frames);
  void frame(const FrameReport& frame);
  void end(const RunReport& report);

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { (void)std::fclose(file); }
  };
  void open_log();
  void say(const std::string& line);
  void show_bar();
  void log(const std::string& event, const std::string& members);
  std::string rate_text() const;

  ProgressOptions options_;
  const std::string log_path_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::FILE* log_ = nullptr;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  bool is_sequence_ = false;
  int frames_ = 0, ended_ = 0, computed_ = 0;
};

}  // namespace alcove
