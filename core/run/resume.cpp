// Looks at the ends of files, since a file cut short has a good beginning.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/resume.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <vector>

#include "core/formats/exr.h"
#include "core/formats/image_io.h"
#include "core/formats/png.h"
#include "core/frame/raw_plane.h"
#include "core/run/frame_files.h"
#include "core/run/plan.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> inputs_of(const Settings& frame) {
  std::vector<std::string> files;
  for (const auto& file : plane_file_options()) files.push_back(frame.input.*file.path);
  return files;
}

/// The bytes that are looked at of a file's beginning, and as many of its end.
constexpr std::streamoff kLooked = 1 << 16;

std::optional<fs::file_time_type> time_of(const std::string& path) {
  std::error_code error;
  const auto time = fs::last_write_time(path, error);
  return error ? std::nullopt : std::optional(time);
}

}  // namespace

std::string identity_of_inputs(const Settings& frame) {
  std::string text;
  for (const auto& path : inputs_of(frame)) {
    text += '\n';
    if (path.empty()) continue;
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const std::streamoff size = file ? std::streamoff(file.tellg()) : 0;
    std::string bytes(std::size_t(std::min(size, 2 * kLooked)), '\0');
    const std::streamoff head = std::min(size, kLooked), tail = std::streamoff(bytes.size()) - head;
    file.seekg(0).read(bytes.data(), head);
    file.seekg(size - tail).read(bytes.data() + head, tail);
    text += fmt::format("{} {:016x}", size, XXH3_64bits(bytes.data(), bytes.size()));
  }
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

bool has_whole_outputs(const Settings& frame, const std::string& options_digest) {
  fs::file_time_type newest_input = fs::file_time_type::min();
  for (const auto& input : inputs_of(frame))
    if (!input.empty()) newest_input = std::max(newest_input, time_of(input).value_or(newest_input));
  const std::string inputs = identity_of_inputs(frame);
  return std::ranges::all_of(outputs_of(frame.output), [&](const OutputFile& output) {
    const auto time = time_of(output.path);
    if (!time || *time < newest_input) return false;
    const bool is_picture = output.path != frame.output.output && output.path != frame.output.composite;
    if (is_picture) return is_whole_png(output.path, made_by(options_digest, inputs));
    return attribute_of_whole_exr(output.path, "alcove/options") == options_digest &&
           attribute_of_whole_exr(output.path, "alcove/inputs") == inputs;
  });
}

}  // namespace alcove
