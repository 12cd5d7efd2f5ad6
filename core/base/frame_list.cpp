// Lists of frames from TOML.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/frame_list.h"

#include <filesystem>
#include <set>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

/// The files of a key that has one or two; none where it is not there.
std::vector<std::string> files_of(const TomlTable& table, const char* key, const std::string& folder) {
  std::vector<std::string> paths;
  if (!table.values.contains(key)) return paths;
  const auto* list = table.values[key].as_array();
  if (!list) return {path_from(folder, table.text(key))};
  for (const auto& entry : *list) {
    const auto name = entry.value<std::string>();
    if (!name || name->empty()) table.refuse(key, "must be one file or two");
    paths.push_back(path_from(folder, *name));
  }
  if (paths.empty() || paths.size() > 2) table.refuse(key, "must be one file or two");
  return paths;
}

std::string file_of(const TomlTable& table, const char* key, const std::string& folder) {
  return table.values.contains(key) ? path_from(folder, table.text(key)) : "";
}

ListedFrame frame_of(const TomlTable& table, const std::string& folder) {
  std::set<std::string> known{"name", "input", "camera", "radius", "truth", "reference", "cpu-reference"};
  for (const auto& row : kLimitTable) known.insert(row.key());
  table.require_keys(known);
  ListedFrame frame{table.text("name"), path_from(folder, table.text("input"))};
  frame.camera = file_of(table, "camera", folder);
  if (table.values.contains("radius")) frame.radius = table.positive("radius");
  frame.truth = files_of(table, "truth", folder);
  frame.reference = files_of(table, "reference", folder);
  frame.cpu_reference = file_of(table, "cpu-reference", folder);
  for (const auto& row : kLimitTable) {
    const std::string key = row.key();
    if (!table.values.contains(key)) continue;
    const double limit = table.number(key.c_str());
    if (limit < row.low || limit > row.high) table.refuse(key.c_str(), "is out of its range, that of the option");
    frame.limits.*row.value = limit;
  }
  return frame;
}

}  // namespace

std::string why_no_place(const std::string& list) {
  return fmt::format("it has no place for the names of {}: write {}, such as out/{}.exr", list, kNamePlace, kNamePlace);
}

bool is_frame_list(const std::string& path) { return lower_case(path).ends_with(".toml"); }

std::vector<ListedFrame> frames_in(const toml::table& root, const std::string& path, const std::string& folder) {
  TomlTable{path, "the list", root}.require_keys(
      {"title", "repeats", "reference-slices", "frame", "candidate", "sweep"});
  std::vector<ListedFrame> frames;
  for_each_table(path, root, "frame", [&](const TomlTable& table) { frames.push_back(frame_of(table, folder)); });
  require_unique_names(path, frames, "frame");
  return frames;
}

std::vector<ListedFrame> read_frame_list(const std::string& path, const char* option) {
  const auto frames = frames_in(read_toml(path, "list of frames", option), path, fs::path(path).parent_path().string());
  for (const auto& frame : frames) {
    if (is_frame_list(frame.input))
      fail(ErrorKind::input, "{}: the input of frame {} is a list itself, {}: name a picture", path, frame.name,
           frame.input);
    if (fs::path(frame.name).filename() != fs::path(frame.name) || frame.name.starts_with('.'))
      fail(ErrorKind::input, "{}: the name {} of the list must be one that a file may have, without / and no dot first",
           path, frame.name);
  }
  return frames;
}

std::string with_name(std::string text, const std::string& name) {
  const std::string place = kNamePlace;
  for (std::size_t at = text.find(place); at != text.npos; at = text.find(place, at + name.size()))
    text.replace(at, place.size(), name);
  return text;
}

}  // namespace alcove
