// By the file, by the ending, by the pattern.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/input_words.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/sequence.h"

namespace alcove {
namespace {

/// The endings of what a frame may be read from.
constexpr std::array<std::string_view, 12> kEndings = {".exr", ".sxr", ".mxr", ".dds", ".tif", ".tiff",
                                                       ".png", ".tga", ".bmp", ".hdr", ".pic", ".rgbe"};

bool is_pattern(const std::string& word) {
  try {
    return frame_pattern(word).has_value();
  } catch (const Error&) {
    return true;  // of two tokens, which the command that takes it complains of
  }
}

}  // namespace

bool names_input(const std::string& word) {
  if (word.empty() || word.starts_with('-')) return false;
  std::error_code error;
  const std::filesystem::path path(word);
  if (std::filesystem::is_regular_file(path, error)) return true;
  const std::string ending = lower_case(path.extension().string());
  return std::ranges::find(kEndings, ending) != kEndings.end() || is_pattern(word);
}

}  // namespace alcove
