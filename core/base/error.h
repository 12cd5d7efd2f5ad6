// The only exception that Alcove throws, and the exit codes its kinds stand for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace alcove {

/// The kind of an error is the program's exit code.
enum class ErrorKind : int {
  some_frames_failed = 1,
  usage = 2,       // usage or settings
  input = 3,       // input missing or unreadable
  output = 4,      // output could not be written
  device = 5,      // no device, or device lost
  comparison = 6,  // a comparison failed
};

/// An error as one sentence without a newline: the fault, its file, frame, part and channel, and the option that mends
/// it.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& text) : std::runtime_error(text), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

template <class... Args>
[[noreturn]] void fail(ErrorKind kind, fmt::format_string<Args...> format, Args&&... args) {
  throw Error(kind, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace alcove
