// Looks at the ends of files, since a file cut short has a good beginning.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/resume.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>

#include "core/exr.h"
#include "core/plan.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

/// The last chunk of a PNG file, behind the four bytes of its length.
constexpr std::string_view kPngEnd("IEND\xae\x42\x60\x82");

bool is_whole_png(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string end(kPngEnd.size(), '\0');
  return file.seekg(-std::streamoff(end.size()), std::ios::end) && file.read(end.data(), std::streamsize(end.size())) && end == kPngEnd;
}

std::optional<fs::file_time_type> time_of(const std::string& path) {
  std::error_code error;
  const auto time = fs::last_write_time(path, error);
  return error ? std::nullopt : std::optional(time);
}

}  // namespace

bool has_whole_outputs(const Settings& frame, const std::string& options_digest) {
  fs::file_time_type newest_input = fs::file_time_type::min();
  const InputSettings& i = frame.input;
  for (const auto* input : {&i.input, &i.depth, &i.normal, &i.position, &i.beauty, &i.material_ao, &i.albedo})
    if (!input->empty()) newest_input = std::max(newest_input, time_of(*input).value_or(newest_input));
  return std::ranges::all_of(outputs_of(frame.output), [&](const OutputFile& output) {
    const auto time = time_of(output.path);
    if (!time || *time < newest_input) return false;
    const bool is_picture = output.path != frame.output.output && output.path != frame.output.composite;
    return is_picture ? is_whole_png(output.path) : attribute_of_whole_exr(output.path, "alcove/options") == options_digest;
  });
}

}  // namespace alcove
