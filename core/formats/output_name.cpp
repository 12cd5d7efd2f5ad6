// Looks at the endings of names.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/sequence.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/base/error.h"
#include "core/base/text.h"

namespace alcove {
namespace {

/// Whether an ending, without its dot, says nothing about the format.
bool is_passed_over(const std::string& ending) {
  static constexpr std::array kOfUnfinished = {"tmp", "temp", "part", "partial", "new"};
  return ending.find_first_not_of("-0123456789") == ending.npos ||
         std::ranges::find(kOfUnfinished, ending) != kOfUnfinished.end();
}

/// The ending of the name with its dot, in small letters, behind which others may be passed over; "" where there is
/// none.
std::string ending_of(const std::string& path) {
  std::filesystem::path name = std::filesystem::path(path).filename();
  while (name.has_extension() && is_passed_over(lower_case(name.extension().string().substr(1)))) name = name.stem();
  return lower_case(name.extension().string());
}

}  // namespace

void require_ending(const std::string& path, const char* option, const char* ending, const char* format) {
  const std::string found = ending_of(path);
  if (found.empty() || found == ending) return;
  fail(ErrorKind::usage, "{}: {} writes {} and nothing else: let its name end in {}", path, option, format, ending);
}

}  // namespace alcove
